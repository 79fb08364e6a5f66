// SPDX-License-Identifier: Apache-2.0
#include "decoder/python/bindings.hpp"

#include <utility>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tagsmith::python {
namespace {

template <std::size_t N>
py::object square_array(const Matrix<N>& matrix) {
  const auto size = static_cast<py::ssize_t>(N);
  py::array_t<double> array({size, size});
  auto cells = array.mutable_unchecked<2>();
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      cells(static_cast<py::ssize_t>(i), static_cast<py::ssize_t>(j)) = matrix[i][j];
    }
  }
  return std::move(array);
}

template <std::size_t N>
py::object square_array_or_none(const std::optional<Matrix<N>>& matrix) {
  if (!matrix) return py::none();
  return square_array(*matrix);
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
  constexpr py::ssize_t kMost = 1 << 30;
  if (array.shape(0) > kMost || array.shape(1) > kMost) throw py::value_error("too large an image");
  return {static_cast<const std::uint8_t*>(array.data()), static_cast<int>(array.shape(1)),
          static_cast<int>(array.shape(0)), array.strides(0)};
}

}  // namespace

Picture picture_from(const py::handle& image) {
  if (py::isinstance<py::array>(image)) {
    return {view_of(py::reinterpret_borrow<py::array>(image)), std::nullopt};
  }
  if (!py::isinstance<py::str>(image) && !py::hasattr(image, "__fspath__")) {
    throw py::type_error("expected a numpy array or a path as the image");
  }
  const auto path = py::cast<std::filesystem::path>(image);
  const py::gil_scoped_release others_run;
  Picture picture{{}, load_image(path)};
  picture.view = picture.loaded->view();
  return picture;
}

std::vector<Survey> surveys_from(const py::handle& surveys) {
  if (surveys.is_none()) return {};
  if (py::isinstance<Survey>(surveys)) return {py::cast<Survey>(surveys)};
  std::vector<Survey> all;
  for (const py::handle one : py::iter(surveys)) all.push_back(py::cast<Survey>(one));
  return all;
}

PlateTemplate plate_from(const py::handle& plate) {
  if (plate.is_none()) return {};
  if (py::isinstance<Survey>(plate)) return py::cast<Survey>(plate).plate();
  return py::cast<PlateTemplate>(plate);
}

Corners corners_from(const py::handle& corners) {
  const py::array_t<double> numbers = numbers_from(corners, 4, 2, "corners");
  const auto cells = numbers.unchecked<2>();
  Corners points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    points[i] = {cells(row, 0), cells(row, 1)};
  }
  return points;
}

CornerCovariance covariance_from(const py::handle& covariance) {
  const py::array_t<double> numbers = numbers_from(covariance, 8, 8, "covariances");
  const auto cells = numbers.unchecked<2>();
  CornerCovariance matrix{};
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    for (std::size_t j = 0; j < matrix.size(); ++j) {
      matrix[i][j] = cells(static_cast<py::ssize_t>(i), static_cast<py::ssize_t>(j));
    }
  }
  return matrix;
}

py::object array_of(const Vector3& vector) { return py::array_t<double>(3, vector.data()); }

py::object array_of(const Corners& corners) {
  py::array_t<double> array({4, 2});
  auto cells = array.mutable_unchecked<2>();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    cells(static_cast<py::ssize_t>(i), 0) = corners[i].x;
    cells(static_cast<py::ssize_t>(i), 1) = corners[i].y;
  }
  return std::move(array);
}

py::object array_of(const Rectangle& rectangle) {
  const std::array<double, 4> sides{rectangle.x, rectangle.y, rectangle.width, rectangle.height};
  return py::array_t<double>(4, sides.data());
}

py::object array_of(const std::vector<Rectangle>& rectangles) {
  py::array_t<double> array({static_cast<py::ssize_t>(rectangles.size()), py::ssize_t{4}});
  auto cells = array.mutable_unchecked<2>();
  for (std::size_t i = 0; i < rectangles.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    cells(row, 0) = rectangles[i].x;
    cells(row, 1) = rectangles[i].y;
    cells(row, 2) = rectangles[i].width;
    cells(row, 3) = rectangles[i].height;
  }
  return std::move(array);
}

py::object array_of(const std::optional<Vector3>& vector) {
  if (!vector) return py::none();
  return array_of(*vector);
}

py::object array_of(const std::optional<Matrix<3>>& matrix) { return square_array_or_none(matrix); }
py::object array_of(const std::optional<Matrix<6>>& matrix) { return square_array_or_none(matrix); }
py::object array_of(const std::optional<Matrix<8>>& matrix) { return square_array_or_none(matrix); }

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
