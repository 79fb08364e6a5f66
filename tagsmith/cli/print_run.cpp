// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_run.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/render/setting_out_sheets.hpp"
#include "tagsmith/render/sheet_files.hpp"
#include "tagsmith/survey/setting_out.hpp"

namespace tagsmith {
namespace {

constexpr const char* kSettingOutList = "setting-out.csv";
constexpr const char* kSettingOutPdf = "setting-out.pdf";
constexpr const char* kManifestJson = "manifest.json";
constexpr const char* kManifestCsv = "manifest.csv";

std::string coordinate(double metres) { return fmt::format("{:.4f}", metres + 0.0); }

// Surveyors' P,E,N,Z,D or P,N,E,Z,D: the header names the columns, so that nobody needs to guess.
std::string setting_out_csv(const Survey& survey, std::span<const SettingOut> list,
                            const PrintExtras& extras) {
  const char* plane = extras.northing_first ? "y,x" : "x,y";
  std::string csv = csv_row(split(fmt::format("tag,{},z,description,side,chainage,offset,height,"
                                              "tolerance,digits,survey",
                                              plane),
                                  ','));
  for (const SettingOut& place : list) {
    const PlacedTag& tag = *place.tag;
    std::array<std::string, 2> xy{coordinate(tag.p_in_grid.x()), coordinate(tag.p_in_grid.y())};
    if (extras.northing_first) std::swap(xy[0], xy[1]);
    csv +=
        csv_row({tag.name, xy[0], xy[1], coordinate(tag.p_in_grid.z()),
                 tag.attitude ? "corner P; the plate " + attitude_text(*tag.attitude) : "corner P",
                 to_string(tag.side), coordinate(place.chainage), coordinate(place.offset),
                 coordinate(place.height), coordinate(place.tolerance), to_string(tag.digits),
                 survey.name});
  }
  return csv;
}

Result<std::string> setting_out_pdf(const Survey& survey, std::span<const SettingOut> list,
                                    const std::string& revision) {
  std::vector<Sheet> sheets = setting_out_table(survey, list, revision);
  Result<std::vector<Sheet>> drawing = setting_out_drawing(survey, list, revision);
  if (!drawing) return fail(drawing.error().message);
  std::ranges::move(*drawing, std::back_inserter(sheets));
  return render_sheets_pdf(sheets);
}

Result<void> write_setting_out(const PrintJob& job, const PrintExtras& extras,
                               const StagedFiles& files, PrintRecord& record) {
  if (!extras.setting_out) return {};
  const Survey& survey = *job.survey;
  std::vector<const PlacedTag*> tags;
  for (const PrintedTag& printed : record.tags) tags.push_back(printed.tag);
  const double tolerance = extras.tolerance > 0 ? extras.tolerance : usual_tolerance(survey);
  const std::vector<SettingOut> list = setting_out(survey, tags, tolerance);
  auto added = files.add(kSettingOutList, setting_out_csv(survey, list, extras));
  if (!added) return added;
  const Result<std::string> pdf = setting_out_pdf(survey, list, job.style.revision);
  if (!pdf) return fail(pdf.error().message);
  record.documents = {kSettingOutList, kSettingOutPdf};
  return files.add(kSettingOutPdf, *pdf);
}

// The unit's pages in files of one extension.
std::vector<ProofPage> proof_pages(const StagedFiles& files, std::span<const Page> pages,
                                   std::span<const PageInFile> places, std::string_view extension) {
  std::vector<ProofPage> list;
  for (const PageInFile& place : places) {
    if (!place.file.ends_with(extension)) continue;
    list.push_back({files.staged(place.file), place.number, &pages[place.index]});
  }
  return list;
}

Result<std::vector<TagProof>> prove_unit(const PrintJob& job, const PrintExtras& extras,
                                         const StagedFiles& files, std::size_t index) {
  const PrintUnit& unit = job.units[index];
  // The reader takes the growth of bars off the frame, so it finds the corners where they will be.
  const std::vector<Page> pages = nominal_pages(job, unit);
  const int first_page = static_cast<int>(index) * pages_a_unit(job) + 1;
  const std::vector<PageInFile> places = pages_in_files(job, unit, first_page);
  std::vector<TagProof> proofs;
  for (const std::string_view extension : {".pdf", ".svg", ".png"}) {
    const std::vector<ProofPage> list = proof_pages(files, pages, places, extension);
    if (list.empty()) continue;
    Result<std::vector<TagProof>> more = extras.prove(*job.survey, list, job.png_dots_per_inch());
    if (!more) return more;
    std::ranges::move(*more, std::back_inserter(proofs));
  }
  return proofs;
}

Result<void> prove_all(const PrintJob& job, const PrintExtras& extras, const StagedFiles& files,
                       PrintRecord& record) {
  if (!extras.prove) return {};
  record.proofs.emplace();
  Result<void> all;
  ProgressBar bar("pages proved", job.units.size());
  run_in_order(job.units.size(), job.style.jobs, [&](std::size_t i) -> Delivery {
    auto proofs =
        std::make_shared<Result<std::vector<TagProof>>>(prove_unit(job, extras, files, i));
    return [&, proofs] {
      bar.advance([] {});
      if (!*proofs) {
        if (all) all = fail(proofs->error().message);
        return;
      }
      std::ranges::move(**proofs, std::back_inserter(*record.proofs));
    };
  });
  return all;
}

Result<void> add_checksums(const StagedFiles& files, PrintRecord& record) {
  std::set<std::string> names(record.documents.begin(), record.documents.end());
  for (const PrintedTag& printed : record.tags) {
    names.insert(printed.files.begin(), printed.files.end());
  }
  for (const std::string& name : names) {
    const Result<std::string> hash = sha256_of_file(files.staged(name));
    if (!hash) return fail(hash.error().message);
    record.sha256[name] = *hash;
  }
  return {};
}

// Each name once: a page in tags.pdf is of many tags.
Result<void> check_files(const PrintRecord& record, const std::filesystem::path& folder,
                         const PrintExtras& extras) {
  std::set<std::string> names{kManifestJson, kManifestCsv};
  if (extras.setting_out) names.insert({kSettingOutList, kSettingOutPdf});
  for (const PrintedTag& printed : record.tags) {
    names.insert(printed.files.begin(), printed.files.end());
  }
  CommandFiles files = extras.files;
  for (const std::string& name : names) files.writes(folder / name, "--output");
  return files.check();
}

}  // namespace

bool has_problems(const PrintRecord& record) {
  return record.proofs && std::ranges::any_of(*record.proofs, [](const TagProof& proof) {
           return !proof.problem.empty();
         });
}

Result<PrintRecord> run_print(const PrintJob& job, const std::filesystem::path& folder,
                              const PrintExtras& extras) {
  PrintRecord record{printed_tags(job), {}};
  if (auto usable = check_files(record, folder, extras); !usable) {
    return fail(usable.error().message);
  }
  Result<StagedFiles> files = StagedFiles::begin(folder);
  if (!files) return fail(files.error().message);
  {
    ProgressBar bar("printed", job.units.size());
    const auto written = write_print(job, *files, [&] { bar.advance([] {}); });
    if (!written) return fail(written.error().message);
  }
  if (auto written = write_setting_out(job, extras, *files, record); !written) {
    return fail(written.error().message);
  }
  if (auto proved = prove_all(job, extras, *files, record); !proved) {
    return fail(proved.error().message);
  }
  if (has_problems(record)) return record;
  if (auto added = add_checksums(*files, record); !added) return fail(added.error().message);
  for (const auto& [name, bytes] : {std::pair{kManifestJson, print_manifest_json(job, record)},
                                    std::pair{kManifestCsv, print_manifest_csv(job, record)}}) {
    if (auto added = files->add(name, bytes); !added) return fail(added.error().message);
  }
  if (auto published = files->publish(); !published) return fail(published.error().message);
  return record;
}

}  // namespace tagsmith
