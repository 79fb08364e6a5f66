// SPDX-License-Identifier: Apache-2.0
#include "decoder/verify/verify_rules.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace tagsmith::detail {
namespace {

constexpr std::array kRules{
    VerifyRule{
        "bars-grown", "unreadable: the bars are wider or narrower than drawn",
        "Ink spread or a wrong exposure of the plate. Print it again, with less ink, on whole "
        "dots of the printer, or with narrower bars: the print command does both."},
    VerifyRule{"bent", "a plate that is not flat: the sides of its feature frame bow",
               "Screw or glue it down flat, or replace it: positions from a bent plate are off."},
    VerifyRule{"blurred", "unreadable: blur wider than the reader follows",
               "Hold the camera still, focus on the plate, or go nearer. If a sharp photo from one "
               "metre says the same, the print is blurred: replace the plate."},
    VerifyRule{"broken-file", "a file that cannot be read",
               "The file is missing, damaged, empty, protected or of another kind, as the message "
               "says. Look at its name, or copy "
               "it again from the camera or print it again."},
    VerifyRule{"changed-file", "a print file that is not the one that was printed",
               "Somebody saved or converted the file. Take the one that was made from the survey."},
    VerifyRule{
        "check-digit", "a check digit that neither scheme gives",
        "The plate was typed by hand or damaged in a digit. Print it again from the survey."},
    VerifyRule{"check-scheme", "the check digit of the other scheme",
               "The plate was made with another program's check digit, or code.check_digit of the "
               "survey was changed after printing. Print it again, or set the survey back."},
    VerifyRule{"contradiction", "tags that do not fit together: one of them hangs wrong",
               "Photograph them together with a third tag: then it is told which. Or measure both "
               "against the setting-out list."},
    VerifyRule{"covered", "unreadable: a part of the bars is covered or damaged",
               "Clean the plate and clear what hangs before it; replace it when it is scratched."},
    VerifyRule{"cut-off", "a tag at the picture's edge, not wholly in view",
               "No fault. Turn the camera if this tag was the one to be checked."},
    VerifyRule{"duplicate", "one tag twice in a picture or print file",
               "On a wall: one of the two plates is a second copy or was hung in the wrong place. "
               "Compare both labels with the setting-out list and take the wrong one down. In a "
               "print file: print that page once."},
    VerifyRule{"end-on", "unreadable: seen too much from the side",
               "Photograph the plate from more in front of it. If it is turned on the wall, set "
               "it straight."},
    VerifyRule{"glare", "unreadable: so bright that the bars are washed out",
               "Move the lamp or the camera to the side, or expose less."},
    VerifyRule{"inverted", "a tag printed white on black",
               "Print it again without `negative`, `invert` or a dark theme. In an SVG or PDF that "
               "was edited, take the file that was made from the survey."},
    VerifyRule{"low-contrast", "unreadable: bars and ground are nearly equal",
               "Clean the plate, light it from the front, and see whether dust or fog is in the "
               "air. Replace a faded plate."},
    VerifyRule{"mirrored", "a mirrored print: the label is on the wrong side of the bars",
               "The plate was printed mirrored, as for the back of a film. Print it again with "
               "mirroring switched off. It still reads, but every position from it is wrong."},
    VerifyRule{"missing-in-file", "a print file without a tag that belongs in it",
               "Print the file again."},
    VerifyRule{
        "mixed-photos", "photos of two moments that were mixed up",
        "Correct the run, or the names of the files: each of the two has the other's photo of "
        "one camera. Where its tags hang was judged as if that were put right."},
    VerifyRule{"moved", "a tag that does not hang where the survey has it",
               "Hang it where the setting-out list says, as the message tells: facing the wall, up "
               "being where the other tags in view have it. Or, when it stays, write its measured "
               "place into the survey's `placed`."},
    VerifyRule{
        "no-common-place", "photos taken together that no place of the cameras explains",
        "Compare the labels of the plates that are named with the setting-out list: a "
        "second copy of a plate hangs wrong, or plates were exchanged. If all hang right, "
        "the photos were not taken together: say which camera took them, or correct the run."},
    VerifyRule{
        "no-frame", "bars whose feature frame is cropped, covered or missing",
        "Photograph, scan or crop so that the whole black frame is there, with white around it and "
        "nothing before it. When the plate itself lacks a part of its frame, print it again."},
    VerifyRule{
        "no-tag", "a picture or page without any tag",
        "If there is a plate in the picture: go nearer, hold still, light it, keep the whole "
        "frame in view. If it is sharp and whole: measure a bar, bars that ran together are "
        "not found. A print file without a tag must be printed again."},
    VerifyRule{"not-in-survey", "a good reading of a code that the survey does not have",
               "Is it the right survey? Otherwise the plate is of another drive or of an older "
               "survey. Verify together with that survey to be told, and take the plate down."},
    VerifyRule{"other-file", "a tag that belongs in another print file",
               "Files were renamed or mixed up. Print them again."},
    VerifyRule{"other-survey", "a tag of another survey that was given, or a print from one",
               "The plate hangs in the wrong drive: hang it where its own setting-out list says. A "
               "print file is to be verified against the survey it was printed from."},
    VerifyRule{"second-copy",
               "a tag in the place of another, while the tag itself hangs in its own",
               "Take the second copy down and hang the tag that belongs there; until then vehicles "
               "are told a wrong position."},
    VerifyRule{"stale", "a print from another state of the survey",
               "Print the tag again; do not hang the old plate."},
    VerifyRule{"swapped", "tags that hang in each other's place, or in that of a third",
               "The two plates were exchanged. Exchange them back by the setting-out list."},
    VerifyRule{"too-dark", "unreadable: too dark", "Light the plate, or expose longer."},
    VerifyRule{"too-small", "unreadable: too few pixels a module",
               "Go nearer or use a longer lens or more pixels."},
    VerifyRule{"undecodable", "unreadable for none of the other causes",
               "Look at the picture of it. Clean the plate; replace it if a sharp photo from one "
               "metre says the same. It may be no tag of this template."},
    VerifyRule{"upside-down", "a tag upside down on its page or wall",
               "Hang the plate with the arrow upwards, or turn the page. If it points up already, "
               "the print "
               "is mirrored: print it again with mirroring switched off."},
    VerifyRule{"wrong-scale", "a frame that is not of the template's size",
               "Print at 100 %, without `fit to page`, and measure the frame before hanging. Of a "
               "scan: is its resolution the one that was stated?"},
    VerifyRule{"wrong-wall", "a tag on the wrong wall, or tags of opposite walls side by side",
               "One of the plates hangs on the wrong wall. Compare both labels with the "
               "setting-out list."},
};

}  // namespace

std::span<const VerifyRule> verify_rules() { return kRules; }

const VerifyRule* find_verify_rule(std::string_view code) {
  const auto rule = std::ranges::find(kRules, code, &VerifyRule::code);
  return rule == kRules.end() ? nullptr : &*rule;
}

std::string verify_rules_table() {
  std::string text = "| rule | finds | what to do |\n|---|---|---|\n";
  for (const VerifyRule& rule : kRules) {
    text += fmt::format("| `{}` | {} | {} |\n", rule.code, rule.finds, rule.remedy);
  }
  return text;
}

}  // namespace tagsmith::detail
