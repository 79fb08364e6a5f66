// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/print_run.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "tagsmith/base/checksum.hpp"
#include "tagsmith/base/csv.hpp"
#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/parallel.hpp"
#include "tagsmith/cli/print_order.hpp"
#include "tagsmith/render/pdf.hpp"
#include "tagsmith/render/setting_out_sheets.hpp"
#include "tagsmith/render/zip_file.hpp"
#include "tagsmith/survey/place_tags.hpp"
#include "tagsmith/tag/printer.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kSettingOutList = "setting-out.csv";
constexpr const char* kSettingOutPdf = "setting-out.pdf";
constexpr const char* kManifestJson = "manifest.json";
constexpr const char* kManifestCsv = "manifest.csv";

std::string coordinate(double metres) { return fmt::format("{:.4f}", metres + 0.0); }

// Surveyors' P,E,N,Z,D or P,N,E,Z,D: the header names the columns, so that nobody needs to guess.
std::string setting_out_csv(const Survey& survey, std::span<const SettingOut> list,
                            bool northing_first) {
  const char* plane = northing_first ? "y,x" : "x,y";
  std::string csv = csv_row(split(fmt::format("tag,{},z,description,side,chainage,offset,height,"
                                              "tolerance,digits,survey",
                                              plane),
                                  ','));
  for (const SettingOut& place : list) {
    const PlacedTag& tag = *place.tag;
    std::array<std::string, 2> xy{coordinate(tag.p_in_grid.x()), coordinate(tag.p_in_grid.y())};
    if (northing_first) std::swap(xy[0], xy[1]);
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
                                    const PrintStyle& style) {
  std::vector<Sheet> sheets =
      setting_out_table(survey, list, style.revision, style.setting_out_paper);
  Result<std::vector<Sheet>> drawing =
      setting_out_drawing(survey, list, style.revision, style.setting_out_paper);
  if (!drawing) return fail(drawing.error().message);
  std::ranges::move(*drawing, std::back_inserter(sheets));
  return render_pdf(sheets);
}

Result<void> write_setting_out(const PrintJob& job, const PrintRecord& record,
                               const StagedFiles& files) {
  if (!job.style.setting_out) return {};
  const Survey& survey = *job.survey;
  std::vector<const PlacedTag*> tags;
  for (const PrintedTag& printed : record.tags) tags.push_back(printed.tag);
  const double tolerance = job.style.tolerance > 0 ? job.style.tolerance : usual_tolerance(survey);
  const std::vector<SettingOut> list = setting_out(survey, tags, tolerance);
  auto added = files.add(kSettingOutList, setting_out_csv(survey, list, job.style.northing_first));
  if (!added) return added;
  const Result<std::string> pdf = setting_out_pdf(survey, list, job.style);
  return pdf ? files.add(kSettingOutPdf, *pdf) : fail(pdf.error().message);
}

Result<std::vector<TagProof>> prove_unit(const PrintJob& job, const StagedFiles& files,
                                         std::size_t unit) {
  const double adjustment = drawn_adjustment(job.style.bar_adjustment, job.dots_per_inch());
  const std::vector<Page> pages = nominal_pages(job, job.units[unit]);
  const std::vector<PageInFile> places = pages_in_files(job, unit);
  std::vector<TagProof> proofs;
  for (const SheetFormat format : job.style.formats) {
    std::vector<ProofPage> list;
    for (const PageInFile& place : places) {
      if (place.format != format) continue;
      list.push_back({files.staged(place.file), place.number, &pages[place.index], adjustment,
                      format == SheetFormat::pdf ? job.printer_scale() : PrinterScale{}});
    }
    Result<std::vector<TagProof>> more =
        job.style.prove(*job.survey, list, job.png_dots_per_inch());
    if (!more) return more;
    std::ranges::move(*more, std::back_inserter(proofs));
  }
  return proofs;
}

Result<void> prove_all(const PrintJob& job, const StagedFiles& files, PrintRecord& record) {
  if (!job.style.prove) return {};
  record.proofs.emplace();
  Result<void> all;
  ProgressBar bar("pages proved", job.units.size());
  run_in_order(job.units.size(), job.style.jobs, [&](std::size_t i) -> Delivery {
    auto proofs = std::make_shared<Result<std::vector<TagProof>>>(prove_unit(job, files, i));
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

// Tags, documents and the names of all files that hold them, still without checksums.
PrintRecord planned_record(const PrintJob& job) {
  PrintRecord record{printed_tags(job), {}};
  if (job.style.setting_out) record.documents = {kSettingOutList, kSettingOutPdf};
  std::ranges::move(order_files(job), std::back_inserter(record.documents));
  for (const std::string& name : record.documents) record.sha256[name];
  for (const PrintedTag& printed : record.tags) {
    for (const std::string& name : printed.files) record.sha256[name];
  }
  return record;
}

// The folder's files, and the ZIP of them.
Result<void> publish_with_zip(const PrintJob& job, const PrintRecord& record, StagedFiles& files) {
  std::vector<ZipEntry> entries;
  for (const auto& [name, hash] : record.sha256) entries.push_back({name, files.staged(name)});
  for (const char* name : {kManifestJson, kManifestCsv}) {
    entries.push_back({name, files.staged(name)});
  }
  const std::filesystem::path& zip = job.style.zip;
  Result<StagedFiles> beside = StagedFiles::begin(zip.has_parent_path() ? zip.parent_path() : ".");
  if (!beside) return fail(beside.error().message);
  if (auto written = write_zip(beside->staged(zip.filename()), entries); !written) return written;
  if (auto published = files.publish(); !published) return published;
  return beside->publish();
}

Result<void> write_all(const PrintJob& job, const std::filesystem::path& folder, StagedFiles& files,
                       PrintRecord& record) {
  {
    ProgressBar bar("printed", job.units.size());
    auto written = write_print(job, files, [&] { bar.advance([] {}); });
    if (!written) return written;
  }
  if (auto written = write_setting_out(job, record, files); !written) return written;
  if (auto written = write_order(job, record, files); !written) return written;
  if (auto proved = prove_all(job, files, record); !proved || has_problems(record)) return proved;
  for (auto& [name, hash] : record.sha256) {
    const Result<std::string> found = sha256_of_file(files.staged(name));
    if (!found) return fail(found.error().message);
    hash = *found;
  }
  keep_earlier_tags(job, folder, record);
  auto added = files.add(kManifestJson, print_manifest_json(job, record));
  if (added) added = files.add(kManifestCsv, print_manifest_csv(job, record));
  if (!added || job.style.zip.empty()) return added ? files.publish() : added;
  return publish_with_zip(job, record, files);
}

}  // namespace

bool has_problems(const PrintRecord& record) {
  return record.proofs && std::ranges::any_of(*record.proofs, [](const TagProof& proof) {
           return !proof.problem.empty();
         });
}

Result<PrintRecord> run_print(const PrintJob& job, const std::filesystem::path& folder,
                              CommandFiles files) {
  PrintRecord record = planned_record(job);
  for (const auto& [name, hash] : record.sha256) files.writes(folder / name, "--output");
  for (const char* name : {kManifestJson, kManifestCsv}) files.writes(folder / name, "--output");
  if (!job.style.zip.empty()) files.writes(job.style.zip, "--zip");
  if (auto usable = files.check(); !usable) return fail(usable.error().message);
  Result<StagedFiles> staged = StagedFiles::begin(folder);
  if (!staged) return fail(staged.error().message);
  const Result<void> written = write_all(job, folder, *staged, record);
  return written ? Result<PrintRecord>(std::move(record)) : fail(written.error().message);
}

}  // namespace tagsmith::detail
