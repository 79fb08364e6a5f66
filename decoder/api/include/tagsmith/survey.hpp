// SPDX-License-Identifier: Apache-2.0
// A surveyed tunnel and the tags in it.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tagsmith/drawing.hpp>
#include <tagsmith/export.hpp>
#include <tagsmith/geometry.hpp>

namespace tagsmith {

enum class Side { left, right };  // of the drive

// How the twelfth digit of a tag follows from the first eleven.
enum class CheckDigit {
  sum10,  // their plain sum modulo 10 (Xu et al. 2017)
  gs1,    // as standard UPC-A has it
};

// A tag where it hangs.
struct SurveyTag {
  std::string name;          // pair and side: 000L
  std::string digits;        // twelve, as printed
  Side side = Side::left;    // the wall
  Vector3 corner_p{};        // P, the upper left inner corner of the feature frame; grid
  Vector3 coded_position{};  // what the digits say; grid
  double chainage = 0;       // of P along the center line, metres
  double sigma = 0;          // standard deviation of a coordinate of P, metres
  bool surveyed = false;     // measured as built, not placed by design
};

// A piece of the center line. Lengths are horizontal.
struct CenterlinePart {
  double length = 0;     // metres, more than 0
  double curvature = 0;  // 1/radius, positive when the drive turns right; 0 = straight
  double grade = 0;      // rise for each horizontal metre
};

// How positions become digits: (position - origin) / resolution, so many digits an axis.
struct PositionCode {
  CheckDigit check_digit = CheckDigit::gs1;
  std::array<int, 3> digit_counts{4, 4, 3};  // for x, y, z; they sum to 11
  Vector3 resolution{0.01, 0.01, 0.01};      // metres
  Vector3 origin{};                          // grid; nothing below it can be coded
};

// A tag of a survey that is made in memory. It hangs on its wall, upright.
struct TagPlace {
  std::string name;                     // pair and side, as 000L
  Vector3 corner_p{};                   // grid
  std::optional<std::string> digits{};  // as printed; absent = those of its own position
  std::optional<double> sigma{};        // metres; absent = the survey's
};

// The parts of a survey.
struct SurveyDescription {
  std::string name;
  bool x_axis_left = false;  // a grid whose x axis points to the left of +y
  Vector3 start{};           // of the center line, on the floor; grid
  double heading = 0;        // there, from +y towards +x
  std::vector<CenterlinePart> centerline;
  double width = 0;   // between the planes of the left and the right plates, metres
  double height = 0;  // of the roof above the floor, metres
  PlateTemplate plate;
  PositionCode code;
  std::vector<TagPlace> tags;
  std::optional<double> sigma{};        // of a surveyed coordinate, metres; absent = 3 mm
  std::optional<double> angle_sigma{};  // of a plate against its wall; absent = 0.3 degrees
};

// An immutable survey; copies share it. A survey that was moved from may only be assigned to.
class TAGSMITH_EXPORT Survey {
 public:
  // Fails with ErrorCode::invalid_argument, naming every problem: names that are no pair and side,
  // positions that the code cannot represent, codes that are not unique, plates that overlap or
  // hang off their wall.
  explicit Survey(const SurveyDescription& description);

  const std::string& name() const;
  const PlateTemplate& plate() const;

  // By pair, left before right.
  const std::vector<SurveyTag>& tags() const;

  // The tag of this name or with these twelve digits; nothing when there is none.
  std::optional<SurveyTag> find(std::string_view name_or_digits) const;

  // Shared by the parts of the library; of no use to others.
  struct Data;
  explicit Survey(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  const Data& data() const { return *data_; }

 private:
  std::shared_ptr<const Data> data_;
};

}  // namespace tagsmith
