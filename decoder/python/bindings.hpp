// SPDX-License-Identifier: Apache-2.0
// What the parts of the Python module share: numpy arrays, and how values show themselves.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tagsmith/drawing.hpp>
#include <tagsmith/files.hpp>
#include <tagsmith/geometry.hpp>

namespace pybind11 {
class handle;
class module_;
class object;
}  // namespace pybind11

namespace tagsmith::python {

// Each adds its classes and functions to the module.
void bind_survey(pybind11::module_& module);
void bind_read(pybind11::module_& module);
void bind_localize(pybind11::module_& module);
void bind_plan(pybind11::module_& module);
void bind_files(pybind11::module_& module);

// A picture that Python gave: a numpy array, which is borrowed, or a path, whose picture is loaded
// and kept. The array must outlive it.
struct Picture {
  ImageView view{};
  std::optional<Image> loaded{};
};

// A numpy array of shape (height, width) and type uint8 whose pixels of a row are neighbours, or
// the path of a picture. Raises TypeError or ValueError on anything else.
Picture picture_from(const pybind11::handle& image);

// Raises TypeError, as "camera is of type Rig, expected a CameraModel".
[[noreturn]] void refuse_type(const std::string& name, const pybind11::handle& value,
                              const std::string& expected);

// One survey, a sequence of them, or None, of the argument of this name.
std::vector<Survey> surveys_from(const std::string& name, const pybind11::handle& surveys);

// None, the plate of a survey, or a PlateTemplate.
PlateTemplate plate_from(const pybind11::handle& plate);

// Corners as an array-like of shape (4, 2), and a covariance of shape (8, 8).
Corners corners_from(const pybind11::handle& corners);
CornerCovariance covariance_from(const pybind11::handle& covariance);

pybind11::object array_of(const Vector3& vector);
pybind11::object array_of(const Corners& corners);
pybind11::object array_of(const Rectangle& rectangle);  // x, y, width, height
pybind11::object array_of(const std::vector<Rectangle>& rectangles);
pybind11::object array_of(const std::optional<Vector3>& vector);
pybind11::object array_of(const std::optional<Matrix<3>>& matrix);
pybind11::object array_of(const std::optional<Matrix<6>>& matrix);
pybind11::object array_of(const std::optional<Matrix<8>>& matrix);

// Reads this member of a value as an array.
template <class Type, class Member>
auto as_array(Member Type::*member) {
  return [member](const Type& value) { return array_of(value.*member); };
}

std::string to_string(Side side);

// How values show themselves by these attributes: "Tag(digits='019000000404', name='000L')".
using Shown = std::function<std::string(const pybind11::object& self)>;
Shown shows(const std::string& type, const std::vector<std::string>& attributes);

}  // namespace tagsmith::python
