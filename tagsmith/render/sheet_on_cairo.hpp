// SPDX-License-Identifier: Apache-2.0
// A sheet drawn by Cairo. Internal to tagsmith/render.
#pragma once

#include <memory>

#include "tagsmith/render/sheet.hpp"

// As cairo.h has them.
typedef struct _cairo cairo_t;                  // NOLINT(bugprone-reserved-identifier)
typedef struct _cairo_surface cairo_surface_t;  // NOLINT(bugprone-reserved-identifier)

namespace tagsmith::detail {

struct CairoDestroy {
  void operator()(cairo_surface_t* surface) const;
  void operator()(cairo_t* context) const;
};
using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDestroy>;
using CairoContext = std::unique_ptr<cairo_t, CairoDestroy>;

// The context's user space is scaled from metres on paper by so many units.
void draw_sheet(cairo_t* context, const Sheet& sheet, double units_per_metre);

}  // namespace tagsmith::detail
