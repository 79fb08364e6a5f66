// SPDX-License-Identifier: Apache-2.0
#include "decoder/python/bindings.hpp"

#include <algorithm>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tagsmith::python {
namespace {

// Numbers of these types lie one after the other.
static_assert(sizeof(Corners) == 8 * sizeof(double) && sizeof(Rectangle) == 4 * sizeof(double) &&
              sizeof(CornerCovariance) == 64 * sizeof(double));

// A copy of numbers that lie row by row.
py::object array_copy(const std::vector<py::ssize_t>& shape, const double* numbers) {
  return py::array_t<double>(shape, numbers);
}

template <std::size_t N>
py::object square_array(const std::optional<Matrix<N>>& matrix) {
  constexpr auto kSize = static_cast<py::ssize_t>(N);
  if (!matrix) return py::none();
  return array_copy({kSize, kSize}, matrix->front().data());
}

// The numbers of an array-like of this shape.
py::array_t<double> numbers_from(const py::handle& value, py::ssize_t rows, py::ssize_t columns,
                                 const std::string& name) {
  using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const auto numbers = Numbers::ensure(value);
  if (!numbers) {
    PyErr_Clear();
    throw py::type_error(name + " are no numbers");
  }
  if (numbers.ndim() != 2 || numbers.shape(0) != rows || numbers.shape(1) != columns) {
    throw py::value_error(name + " are not of shape (" + std::to_string(rows) + ", " +
                          std::to_string(columns) + ")");
  }
  return numbers;
}

ImageView view_of(const py::array& array) {
  const bool bytes = array.dtype().kind() == 'u' && array.itemsize() == 1;
  if (!bytes || array.ndim() != 2) {
    throw py::value_error(
        "the image is an array of " + std::string(py::str(array.dtype())) + " with " +
        std::to_string(array.ndim()) +
        " dimensions, expected uint8 of shape (height, width): make grey of colours first");
  }
  if (array.size() > 0 && array.shape(1) > 1 && array.strides(1) != 1) {
    throw py::value_error("the pixels of a row are not neighbours: use numpy.ascontiguousarray");
  }
  // numpy says 0 where all rows are the same, ImageView where they follow each other.
  if (array.shape(0) > 1 && array.strides(0) == 0) {
    throw py::value_error("all rows of the image are one row: use numpy.ascontiguousarray");
  }
  constexpr py::ssize_t kMost = 1 << 30;
  if (array.shape(0) > kMost || array.shape(1) > kMost) throw py::value_error("too large an image");
  return {static_cast<const std::uint8_t*>(array.data()), static_cast<int>(array.shape(1)),
          static_cast<int>(array.shape(0)), array.shape(0) > 1 ? array.strides(0) : array.shape(1)};
}

// Of a str, or of what has __fspath__.
std::filesystem::path path_from(const py::handle& value) {
  try {
    return py::cast<std::filesystem::path>(value);
  } catch (const py::cast_error&) {
    throw py::value_error("no file can have the path " + std::string(py::repr(value)));
  }
}

}  // namespace

void refuse_type(const std::string& name, const py::handle& value, const std::string& expected) {
  const std::string type = py::str(py::type::handle_of(value).attr("__name__"));
  throw py::type_error(name + " is of type " + type + ", expected " + expected);
}

Picture picture_from(const py::handle& image) {
  if (py::isinstance<py::array>(image)) {
    return {view_of(py::reinterpret_borrow<py::array>(image)), std::nullopt};
  }
  if (!py::isinstance<py::str>(image) && !py::hasattr(image, "__fspath__")) {
    refuse_type("image", image, "a numpy array or a path");
  }
  const std::filesystem::path path = path_from(image);
  const py::gil_scoped_release others_run;
  Picture picture{{}, load_image(path)};
  picture.view = picture.loaded->view();
  return picture;
}

std::vector<Survey> surveys_from(const std::string& name, const py::handle& surveys) {
  if (surveys.is_none()) return {};
  if (py::isinstance<Survey>(surveys)) return {py::cast<Survey>(surveys)};
  const std::string expected = "a Survey, as of Survey.load(path), or several";
  const bool is_text = py::isinstance<py::str>(surveys) || py::isinstance<py::bytes>(surveys);
  if (is_text || !py::isinstance<py::iterable>(surveys)) {
    refuse_type(name, surveys, expected);
  }
  std::vector<Survey> all;
  for (const py::handle one : py::iter(surveys)) {
    if (!py::isinstance<Survey>(one)) refuse_type("an element of " + name, one, expected);
    all.push_back(py::cast<Survey>(one));
  }
  return all;
}

PlateTemplate plate_from(const py::handle& plate) {
  if (plate.is_none()) return {};
  if (py::isinstance<Survey>(plate)) return py::cast<Survey>(plate).plate();
  if (!py::isinstance<PlateTemplate>(plate)) {
    refuse_type("plate", plate, "a PlateTemplate or a Survey");
  }
  return py::cast<PlateTemplate>(plate);
}

Corners corners_from(const py::handle& corners) {
  const py::array_t<double> numbers = numbers_from(corners, 4, 2, "corners");
  Corners points;
  std::copy_n(numbers.data(), numbers.size(), &points.front().x);
  return points;
}

CornerCovariance covariance_from(const py::handle& covariance) {
  const py::array_t<double> numbers = numbers_from(covariance, 8, 8, "covariances");
  CornerCovariance matrix{};
  std::copy_n(numbers.data(), numbers.size(), matrix.front().data());
  return matrix;
}

py::object array_of(const Vector3& vector) { return array_copy({3}, vector.data()); }

py::object array_of(const Corners& corners) { return array_copy({4, 2}, &corners.front().x); }

py::object array_of(const Rectangle& rectangle) { return array_copy({4}, &rectangle.x); }

py::object array_of(const std::vector<Rectangle>& rectangles) {
  return array_copy({static_cast<py::ssize_t>(rectangles.size()), 4},
                    rectangles.empty() ? nullptr : &rectangles.front().x);
}

py::object array_of(const std::optional<Vector3>& vector) {
  if (!vector) return py::none();
  return array_of(*vector);
}

py::object array_of(const std::optional<Matrix<3>>& matrix) { return square_array(matrix); }
py::object array_of(const std::optional<Matrix<6>>& matrix) { return square_array(matrix); }
py::object array_of(const std::optional<Matrix<8>>& matrix) { return square_array(matrix); }

std::string to_string(Side side) { return side == Side::left ? "left" : "right"; }

Shown shows(const std::string& type, const std::vector<std::string>& attributes) {
  return [type, attributes](const py::object& self) {
    std::string text = type + "(";
    for (const std::string& name : attributes) {
      if (text.back() != '(') text += ", ";
      py::object attribute = self.attr(name.c_str());
      if (py::isinstance<py::array>(attribute)) attribute = attribute.attr("tolist")();
      text += name + "=" + std::string(py::repr(attribute));
    }
    return text + ")";
  };
}

}  // namespace tagsmith::python
