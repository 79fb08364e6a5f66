// SPDX-License-Identifier: Apache-2.0
#include <tagsmith/files.hpp>

#include "decoder/api/data.hpp"
#include "tagsmith/base/file.hpp"
#include "tagsmith/cli/print_job.hpp"
#include "tagsmith/render/page_sheet.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith {
namespace {

// The bytes of the tag's page in the format of the path.
std::string page_bytes(const detail::Survey& survey, const detail::PlacedTag& tag,
                       const std::filesystem::path& path) {
  detail::PrintStyle style;
  style.revision = survey_revision(survey);
  const auto job = detail::plan_print(survey, {&tag}, style);
  if (!job) throw Error(ErrorCode::failed, job.error().message);
  std::vector<detail::Sheet> sheets;
  for (const detail::Page& page : pages_of(*job, job->units.front())) {
    sheets.push_back(sheet_of(page));
  }
  const auto files = detail::render_sheets(sheets, path);
  if (!files) throw Error(ErrorCode::failed, files.error().message);
  return files->front().bytes;
}

}  // namespace

void print_tag(const Survey& survey, const std::string& tag, const std::filesystem::path& path) {
  const detail::Survey& known = survey.data().survey;
  const detail::PlacedTag* placed = find_tag(known, tag);
  if (placed == nullptr) {
    detail::throw_invalid("the survey " + known.name + " has no tag `" + tag + "`");
  }
  if (!detail::sheet_format_of(path)) {
    detail::throw_invalid(path.string() + ": expected a name that ends in .pdf, .svg or .png");
  }
  const auto written = detail::write_file(path, page_bytes(known, *placed, path));
  if (!written) throw Error(ErrorCode::unwritable_file, written.error().message);
}

}  // namespace tagsmith
