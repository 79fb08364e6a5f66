// SPDX-License-Identifier: Apache-2.0
// What is seen of tags in one picture. Findings are functions of it (findings.hpp); what only one
// of them needs is measured there.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reading.hpp"
#include "decoder/verify/manifest.hpp"
#include "decoder/verify/verified_file.hpp"
#include "tagsmith/geometry/camera.hpp"
#include "tagsmith/survey/survey.hpp"
#include "tagsmith/tag/template.hpp"

namespace tagsmith::detail {

// ---- Mirrored prints.

// The evidence that a tag is a mirrored print; empty when it is not. A UPC-A symbol mirrored has
// the bars of the same symbol upside down, so its bars cannot show it. The label can: it stands
// below the frame as the bars are read, and above it in a mirrored print. Detected where that place
// is white and ink stands in the opposite one, from 4 px a module on. Where the frame is 5 mm and
// more above or below the plate's middle, the plate's edges show the same from 2 px a module on,
// before a dark ground.
std::string find_mirroring(const GrayView& image, const TagTemplate& tag,
                           const FrameCorners& corners, double module_px);

// ---- What is seen.

// How a tag came to be seen.
enum class Sight {
  read,       // in its frame
  refused,    // found, and refused by the reader
  negative,   // read after black and white were exchanged
  thinned,    // read after ink was taken away
  thickened,  // read after ink was added
  bars,       // read by its bars, without a frame
  part,       // known by the part of it that is in sight
};

struct TagEvidence {
  VerifiedTag tag;  // what was read of it; `ok` until a finding is made
  Sight sight = Sight::read;
  const Rejection* refusal = nullptr;  // why it was refused
  std::string by_bars{};               // for a refused tag: which tag it is by its bars, in words
  std::string fits{};                  // of a part: the tags of the survey that it fits, in words
  std::string mirrored{};              // the evidence that the print is mirrored; empty = it is not
};

struct PictureEvidence {
  const Survey& survey;
  GrayView image;
  std::span<const Survey> also{};  // other surveys, whose tags do not belong here

  // Of a photo.
  bool is_photo = false;
  std::optional<int> orientation{};  // EXIF; nothing = not noted
  const Camera* camera = nullptr;    // that took it, of the photo's size; null = not known

  // Of a print file's page, or a flat scan.
  int page = 0;  // from 1; 0 of what has no pages
  double metres_per_pixel = 0;
  std::span<const ManifestTag> expected{};     // what the manifest says the file holds
  std::span<const VerifiedTag> other_pages{};  // what earlier pages of the file hold

  UpSource up = UpSource::unknown;

  ReadResult readings{};
  std::vector<TagEvidence> tags{};
};

// The function that reads a picture: read_tags, or a test's wrapper around it.
using PictureReading = std::function<ReadResult(const GrayView&, const ReadOptions&)>;

// Reads the picture and fills `readings` and `tags`: first with any code allowed, so that a tag
// that should not be there is recognised; what is refused then, with the survey's codes only, for
// tags too small or too worn otherwise. Where no tag is read by its frame, also the picture's
// negative and the survey's tags by their bars; and a page with more ink and with less. Tags of
// which a photo shows a part are compared with the survey's.
void see_tags(const PictureReading& read, PictureEvidence& evidence);

// A result without refusals that overlap any reading. Of refusals that overlap each other the one
// is kept that was nearest to a reading.
ReadResult without_repeats(ReadResult result);

// Whether an outline, enlarged by this share of its size on every side, would leave the picture.
bool leaves(const FrameCorners& corners, const GrayView& image, double larger_by = 0);

// "000L", or the digits of a tag of no survey.
std::string name_of(const Survey& survey, const Digits& digits);

// The survey's tag whose digits differ least from these: the one that differs in the check digit
// alone, if there is one. Null where two tags are equally near, and where the digits are right by
// the other scheme of check digits: these were not misread.
const PlacedTag* nearest_tag(const Survey& survey, const Digits& digits);

// In how many digits two codes differ.
int differing_digits(const Digits& a, const Digits& b);

// The other survey that has the tag, or null.
const Survey* home_of(std::span<const Survey> also, const Digits& digits);

}  // namespace tagsmith::detail
