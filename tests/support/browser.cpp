// SPDX-License-Identifier: Apache-2.0
#include "tests/support/browser.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/support/program.hpp"

namespace tagsmith::detail::test {
namespace {

namespace fs = std::filesystem;

// The page in a frame of the wanted size, because Chromium's own window has a least width. The
// result is written in hexadecimal UTF-8, which the dump of the document leaves as it is.
std::string wrapper(int width, int height, const std::string& script) {
  return "<!doctype html><meta charset=\"utf-8\"><iframe id=\"frame\" style=\"border:0;width:" +
         std::to_string(width) + "px;height:" + std::to_string(height) +
         "px\" src=\"page.html\"></iframe><pre id=\"result\"></pre>\n<script>\n"
         "const frame = document.getElementById('frame');\n"
         "async function visit(page, doc) {\n" +
         script +
         "\n}\n"
         "frame.addEventListener('load', async () => {\n"
         "  let text;\n"
         "  try { text = 'ok' + JSON.stringify(await visit(frame.contentWindow, "
         "frame.contentDocument)); }\n"
         "  catch (error) { text = 'no' + error; }\n"
         "  const bytes = [...new TextEncoder().encode(text)];\n"
         "  document.getElementById('result').textContent =\n"
         "    'hex:' + bytes.map(b => b.toString(16).padStart(2, '0')).join('') + ':';\n"
         "});\n</script>\n";
}

std::string text_of_hex(const std::string& hex) {
  std::string text;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    text += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  }
  return text;
}

std::vector<std::string> console_lines(const std::string& log) {
  std::vector<std::string> lines;
  std::istringstream stream(log);
  for (std::string line; std::getline(stream, line);) {
    if (line.find("CONSOLE") != std::string::npos) lines.push_back(line);
  }
  return lines;
}

}  // namespace

PageVisit visit_page(const fs::path& page, int width, int height, const std::string& script) {
  if (!has_program("chromium")) {
    throw std::runtime_error("chromium is not installed: run ./dev setup");
  }
  const TemporaryFolder folder;
  fs::copy_file(page, folder.path() / "page.html");
  std::ofstream(folder.path() / "index.html") << wrapper(width, height, script);
  const std::string path = folder.path().string();
  const ProgramOutput output = run_shell(
      "HOME='" + path +
      "' timeout 60 chromium --headless --no-sandbox --disable-gpu "
      "--disable-dev-shm-usage --no-first-run --disable-extensions --enable-logging=stderr "
      "--allow-file-access-from-files --host-resolver-rules='MAP * ~NOTFOUND' "
      "--user-data-dir='" +
      path +
      "/profile' --virtual-time-budget=5000 --window-size=1400,1000 "
      "--dump-dom 'file://" +
      path + "/index.html'");
  const std::size_t begin = output.out.find(">hex:");
  const std::size_t end = output.out.find(":<", begin);
  if (begin == std::string::npos || end == std::string::npos) {
    throw std::runtime_error("chromium ended with " + std::to_string(output.exit_code) +
                             " and no result: " + output.err);
  }
  const std::string text = text_of_hex(output.out.substr(begin + 5, end - begin - 5));
  if (!text.starts_with("ok")) throw std::runtime_error("the page's script: " + text.substr(2));
  return {text.substr(2), console_lines(output.err)};
}

}  // namespace tagsmith::detail::test
