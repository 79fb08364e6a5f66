// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tagsmith/base/text.hpp"
#include "tagsmith/cli/commands.hpp"
#include "tagsmith/cli/common_options.hpp"
#include "tagsmith/cli/console.hpp"
#include "tagsmith/cli/json_text.hpp"
#include "tagsmith/cli/print_only.hpp"
#include "tagsmith/geometry/angle.hpp"
#include "tagsmith/survey/compare.hpp"
#include "tagsmith/survey/read_survey.hpp"
#include "tagsmith/survey/revision.hpp"

namespace tagsmith::detail {
namespace {

struct DiffOptions {
  std::string before;
  std::string after;
  bool json = false;
};

auto count_of(const std::vector<TagDifference>& differences, TagChange change) {
  return std::ranges::count(differences, change, &TagDifference::change);
}

void print_json(const std::vector<TagDifference>& differences,
                const std::vector<ReadElsewhere>& misread, const Survey& after) {
  const auto in_degrees = [](double angle) { return with_decimals(degrees(angle), 3); };
  for (const TagDifference& difference : differences) {
    to_stdout("{}\n", json_text({{"tag", difference.tag},
                                 {"change", to_string(difference.change)},
                                 {"distance", with_decimals(difference.distance, 6)},
                                 {"turn_deg", json_list(difference.turn, in_degrees)},
                                 {"reason", difference.reason}}));
  }
  const auto name_of = [](const ReadElsewhere& plate) { return plate.tag; };
  to_stdout("{}\n", json_text({{"summary",
                                {{"print", count_of(differences, TagChange::print)},
                                 {"reprint", count_of(differences, TagChange::reprint)},
                                 {"move", count_of(differences, TagChange::move)},
                                 {"remove", count_of(differences, TagChange::remove)},
                                 {"read_elsewhere", json_list(misread, name_of)},
                                 {"revision", survey_revision(after)}}}}));
}

// Standard output is a list that `print --only` takes; the count goes to standard error.
void print_words(const std::vector<TagDifference>& differences, const Survey& before,
                 const Survey& after) {
  for (const TagDifference& difference : differences) {
    to_stdout("{:<7} {}  {}\n", to_string(difference.change), difference.tag, difference.reason);
  }
  if (!differences.empty()) to_stdout("{}{}\n", kRevisionLine, survey_revision(after));
  to_stderr("{} {} -> {}: {} to print, {} to reprint, {} to move, {} to remove\n", after.name,
            survey_revision(before), survey_revision(after),
            count_of(differences, TagChange::print), count_of(differences, TagChange::reprint),
            count_of(differences, TagChange::move), count_of(differences, TagChange::remove));
}

void warn_of_misread_plates(const std::vector<ReadElsewhere>& plates) {
  constexpr std::size_t kShown = 3;
  std::vector<std::string> shown;
  for (const ReadElsewhere& plate : std::span(plates).first(std::min(kShown, plates.size()))) {
    shown.push_back(fmt::format("the plate of {} as {}, {} mm off", plate.tag, plate.read_as,
                                format_number(1000 * plate.distance, 1)));
  }
  to_stderr(
      "diff: warning: until moved or taken down, {} read as tags elsewhere by the new survey "
      "({}{}): do not localize with it before\n",
      plates.size() == 1 ? "a plate that hangs is"
                         : counted(plates.size(), "plate") + " that hang are",
      fmt::join(shown, "; "), plates.size() > kShown ? "; ..." : "");
}

Result<int> diff(const DiffOptions& options) {
  const Result<Survey> before = load_survey(options.before);
  if (!before) return fail(before);
  const Result<Survey> after = load_survey(options.after);
  if (!after) return fail(after);
  const std::vector<TagDifference> differences = compare_surveys(*before, *after);
  const bool same = survey_revision(*before) == survey_revision(*after);
  if (differences.empty() && !same) {
    to_stderr(
        "diff: the surveys differ in what no plate that hangs needs: labels, holes, standard "
        "deviations, the tunnel's walls or the like\n");
  }
  const std::vector<ReadElsewhere> misread = read_elsewhere(*before, *after);
  if (!misread.empty()) warn_of_misread_plates(misread);
  if (options.json) {
    print_json(differences, misread, *after);
  } else {
    print_words(differences, *before, *after);
  }
  return differences.empty() ? kExitOk : kExitFindings;
}

}  // namespace

Command diff_command() {
  const auto options = std::make_shared<DiffOptions>();
  return {
      .name = "diff",
      .summary = "What to print, reprint, move and remove when a survey changes",
      .options = {required(argument("OLD", &options->before, ValueKind::survey,
                                    "The survey as the plates were made")),
                  required(argument("NEW", &options->after, ValueKind::survey,
                                    "The survey as it is now")),
                  json_flag(options->json, "One JSON object a tag that differs, then the summary")},
      .notes =
          "A line a tag: what to do, its name, why. `tagsmith print NEW --only FILE` prints what "
          "it asks for. Exit: 0 nothing to do, 1 something is, 2 a survey cannot be read.\n\n"
          "Example:\n"
          "  tagsmith diff old/survey.yaml survey.yaml > changes.txt\n"
          "  tagsmith print survey.yaml -o out/changed --only changes.txt",
      .run = [options] { return diff(*options); },
  };
}

}  // namespace tagsmith::detail
