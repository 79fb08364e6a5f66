// SPDX-License-Identifier: Apache-2.0
// Image -> readings. Needs no OpenCV to call.
#pragma once

#include <memory>
#include <vector>

#include "decoder/image/gray.hpp"
#include "decoder/reader/read_options.hpp"
#include "decoder/reader/reading.hpp"

namespace tagsmith::detail {

// All tags in the image, whatever their rotation and perspective, and what was refused and why.
ReadResult read_tags(const GrayView& image, const ReadOptions& options = {});

// The same in two steps, for a caller who may know after the first that the second is not needed;
// it can take many times as long. The image must outlive the reader.
class TagSearch {
 public:
  // Reads the tags whose frames are seen whole: where they are expected, and all over the image as
  // `options.search` says.
  TagSearch(const GrayView& image, const ReadOptions& options);
  TagSearch(TagSearch&&) noexcept;
  TagSearch& operator=(TagSearch&&) noexcept;
  ~TagSearch();

  // Reads frames that are in pieces or partly out of the image, and tags that are partly covered:
  // looks around the bars that no reading explains. Nothing where the image was
  // not searched, or has been looked at closer before.
  void look_closer();

  // The tags read so far.
  const std::vector<Reading>& tags() const;

  // The same with what was refused and why, and symbols without a frame as the options say.
  ReadResult result() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tagsmith::detail
