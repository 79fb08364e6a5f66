// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <tagsmith/files.hpp>

#include "decoder/api/data.hpp"
#include "decoder/verify/verify_file.hpp"
#include "tagsmith/cli/parallel.hpp"

namespace tagsmith {
namespace {

VerifiedTag tag_from(const detail::VerifiedTag& tag) {
  VerifiedTag verified;
  verified.tag = tag.tag;
  if (tag.digits) verified.digits = detail::to_string(*tag.digits);
  verified.status = static_cast<TagStatus>(tag.finding.status);
  verified.rule = tag.finding.rule;
  verified.message = tag.finding.message;
  verified.corners = detail::corners_from(tag.corners);
  verified.page = tag.page;
  if (tag.grade) verified.grade = tag.grade->grade;
  return verified;
}

static_assert(static_cast<int>(TagStatus::doubtful) ==
              static_cast<int>(detail::TagStatus::doubtful));
static_assert(static_cast<int>(TagStatus::doubtful) + 1 == detail::kTagStatuses);

VerifiedFile file_from(const std::filesystem::path& path,
                       const detail::Result<detail::VerifiedFile>& verified) {
  VerifiedFile file;
  file.file = path.string();
  if (!verified) {
    file.readable = false;
    file.findings.push_back(verified.error().message);
    return file;
  }
  std::ranges::transform(verified->tags, std::back_inserter(file.tags), tag_from);
  file.findings = verified->findings;
  file.notes = verified->notes;
  file.stale = verified->stale;
  return file;
}

}  // namespace

const char* to_string(TagStatus status) noexcept {
  return detail::kTagStatusNames[static_cast<std::size_t>(status)];
}

bool VerifiedFile::is_ok() const {
  const auto in_order = [](const VerifiedTag& tag) {
    return tag.status == TagStatus::ok || tag.status == TagStatus::cut_off;
  };
  return findings.empty() && std::ranges::all_of(tags, in_order);
}

std::vector<VerifiedFile> verify(const Survey& survey,
                                 const std::vector<std::filesystem::path>& paths,
                                 const VerifyOptions& options) {
  if (options.scan_dpi) detail::check_number("scan_dpi", *options.scan_dpi, 1, 10'000);
  detail::check_number("jobs", options.jobs, 0, 100'000);
  std::vector<Survey> together{survey};
  together.insert(together.end(), options.also.begin(), options.also.end());
  const std::vector<detail::Survey> surveys = detail::surveys_from(together);
  const std::vector<detail::Survey> also(surveys.begin() + 1, surveys.end());
  detail::ManifestCache manifests;
  const detail::VerifyRequest request{.survey = surveys.front(),
                                      .also = also,
                                      .manifests = &manifests,
                                      .scan_dpi = options.scan_dpi};
  std::vector<VerifiedFile> files(paths.size());
  detail::run_in_order(paths.size(), options.jobs, [&](std::size_t i) -> detail::Delivery {
    files[i] = file_from(paths[i], detail::verify_file(request, paths[i]));
    return [] {};
  });
  return files;
}

}  // namespace tagsmith
