// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/render/text.hpp"

#include <algorithm>
#include <cairo.h>
#include <map>
#include <memory>
#include <string_view>
#include <tuple>

#include <fmt/format.h>
#include <pango/pangocairo.h>

#include "tagsmith/base/text.hpp"
#include "tagsmith/tag/drawing.hpp"

namespace tagsmith::detail {
namespace {

// Text is laid out at one font size and scaled to its height when drawn, so that its shape does not
// depend on the size.
constexpr double kFontSize = 100;

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};
using Context = std::unique_ptr<PangoContext, Unref>;
using Layout = std::unique_ptr<PangoLayout, Unref>;

// Font options and language are pinned: the machine's settings must not change a print.
Context make_context() {
  // Pango's default font map is one per thread.
  Context context(pango_font_map_create_context(pango_cairo_font_map_get_default()));
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  pango_cairo_context_set_font_options(context.get(), options);
  cairo_font_options_destroy(options);
  pango_cairo_context_set_resolution(context.get(), 72);
  pango_context_set_round_glyph_positions(context.get(), FALSE);
  pango_context_set_language(context.get(), pango_language_from_string("en"));
  pango_context_set_base_dir(context.get(), PANGO_DIRECTION_LTR);
  return context;
}

// Of the scripts that are written from right to left (Unicode blocks from Hebrew to Arabic
// Extended-A, their presentation forms, and those of the supplementary plane).
bool is_right_to_left(gunichar c) {
  return (c >= 0x0590 && c <= 0x08FF) || (c >= 0xFB1D && c <= 0xFDFF) ||
         (c >= 0xFE70 && c <= 0xFEFF) || (c >= 0x10800 && c <= 0x10FFF) ||
         (c >= 0x1E800 && c <= 0x1EFFF);
}

// Whether the first letter is of such a script: then the line is read from the right.
bool begins_right_to_left(const std::string& text) {
  for (const char* at = text.c_str(); *at != '\0'; at = g_utf8_next_char(at)) {
    const gunichar c = g_utf8_get_char(at);
    if (g_unichar_isalpha(c) != FALSE) return is_right_to_left(c);
  }
  return false;
}

// Beside words from right to left, the text between them from its first to its last letter or digit
// keeps its own order, as a left-to-right isolate (Unicode Standard Annex 9): otherwise groups of
// digits would be set in reversed order, and minus signs behind their numbers. The same applies to
// the parts that a middle dot joins, in the direction of the line.
std::string with_isolates(const std::string& text) {
  constexpr gunichar kMiddleDot = 0x00B7;
  const std::string kBegin = "\u2066", kEnd = "\u2069";
  const std::string mark = begins_right_to_left(text) ? "\u200F" : "\u200E";
  std::string result;
  std::string run;        // since the last character from right to left
  std::size_t first = 0;  // of the run that is isolated
  std::size_t last = 0;   // past it; 0 = none is
  bool any = false;
  const auto end_run = [&] {
    if (last > 0) {
      run.insert(last, kEnd);
      run.insert(first, kBegin);
    }
    result += run;
    run.clear();
    last = 0;
  };
  for (const char* at = text.c_str(); *at != '\0'; at = g_utf8_next_char(at)) {
    const gunichar c = g_utf8_get_char(at);
    const std::size_t before = run.size();
    const std::string_view bytes(at, static_cast<std::size_t>(g_utf8_next_char(at) - at));
    if (is_right_to_left(c)) {
      any = true;
      end_run();
      result += bytes;
      continue;
    }
    if (c == kMiddleDot) {
      end_run();
      result += mark;
      result += bytes;
      result += mark;
      continue;
    }
    run += bytes;
    if (g_unichar_isalnum(c) == FALSE) continue;
    const bool has_sign = before > 0 && (run[before - 1] == '-' || run[before - 1] == '+');
    if (last == 0) first = has_sign ? before - 1 : before;
    last = run.size();
  }
  end_run();
  return any ? result : text;
}

// `plain` is printable text.
Layout make_layout(PangoContext* context, const std::string& plain) {
  const std::string text = with_isolates(plain);
  Layout layout(pango_layout_new(context));
  PangoFontDescription* font = pango_font_description_from_string("DejaVu Sans");
  pango_font_description_set_absolute_size(font, kFontSize * PANGO_SCALE);
  pango_layout_set_font_description(layout.get(), font);
  pango_font_description_free(font);
  pango_layout_set_auto_dir(layout.get(), begins_right_to_left(plain) ? TRUE : FALSE);
  pango_layout_set_single_paragraph_mode(layout.get(), TRUE);
  // Ligatures would be copied and searched as other letters.
  PangoAttrList* attributes = pango_attr_list_new();
  pango_attr_list_insert(attributes, pango_attr_font_features_new("liga=0, clig=0"));
  pango_layout_set_attributes(layout.get(), attributes);
  pango_attr_list_unref(attributes);
  pango_layout_set_text(layout.get(), text.c_str(), static_cast<int>(text.size()));
  return layout;
}

// Reaches of a laid-out line from the left end of its baseline, in layout units.
struct Extents {
  double ascent = 0;
  double descent = 0;
  double width = 0;
};

Extents extents_of(PangoLayout* layout) {
  PangoRectangle ink{};
  PangoRectangle logical{};
  pango_layout_line_get_extents(pango_layout_get_line_readonly(layout, 0), &ink, &logical);
  return {static_cast<double>(-ink.y) / PANGO_SCALE,
          static_cast<double>(ink.y + ink.height) / PANGO_SCALE,
          static_cast<double>(logical.width) / PANGO_SCALE};
}

// The layout that every line of text starts from, made once a thread: making it takes longer than
// setting the line.
struct TextTools {
  Context context;
  double capital = 0;  // height of a capital letter in layout units; 0 without any font
};

const TextTools& text_tools() {
  thread_local const TextTools tools = [] {
    TextTools made{make_context()};
    made.capital = extents_of(make_layout(made.context.get(), "H").get()).ascent;
    return made;
  }();
  return tools;
}

struct SetText {
  Layout layout;     // null when the machine has no font at all
  double scale = 0;  // metres of one layout unit
  double width = 0;  // layout units
};

double shrink_to(double room, double length) {
  return length > room ? std::max(room, 0.0) / length : 1.0;
}

void ellipsize(PangoLayout* layout, double width) {
  constexpr double kMostUnits = 1e9;  // Pango counts in 32 bits
  const double units = std::clamp(width * PANGO_SCALE, 0.0, kMostUnits);
  pango_layout_set_ellipsize(layout, PANGO_ELLIPSIZE_END);
  pango_layout_set_width(layout, static_cast<int>(units));
}

SetText lay_out_text(const SheetText& text) {
  SetText set;
  const auto& [context, capital] = text_tools();
  if (capital <= 0) return set;
  set.layout = make_layout(context.get(), printable_text(text.text));
  const double scale = text.height / capital;
  double shrink = shrink_to(text.max_width / scale, extents_of(set.layout.get()).width);
  if (shrink < kLeastTextShrink) {
    shrink = kLeastTextShrink;
    ellipsize(set.layout.get(), text.max_width / (scale * shrink));
  }
  const Extents extents = extents_of(set.layout.get());
  shrink = std::min({shrink, shrink_to(kTextAscent * capital, extents.ascent),
                     shrink_to(kTextDescent * capital, extents.descent)});
  set.scale = scale * shrink;
  set.width = extents.width;
  return set;
}

// Pages of one print repeat most of their texts: the last ones are kept, separately for each
// thread.
const SetText& set_text(const SheetText& text) {
  constexpr std::size_t kKept = 64;
  using Key = std::tuple<std::string, double, double>;
  thread_local std::map<Key, SetText> kept;
  const Key key{text.text, text.height, text.max_width};
  if (const auto found = kept.find(key); found != kept.end()) return found->second;
  if (kept.size() == kKept) kept.clear();
  return kept.emplace(key, lay_out_text(text)).first->second;
}

PangoLayoutLine* only_line(const SetText& set) {
  return pango_layout_get_line_readonly(set.layout.get(), 0);
}

// Where the line begins, layout units from the text's place.
double start_of(const SheetText& text, const SetText& set) {
  return text.centred ? -set.width / 2 : 0;
}

std::string path_data(const cairo_path_t& path) {
  // Much finer than a printer's dot; nanometres would only enlarge the file.
  constexpr int kDecimals = 4;
  std::string data;
  for (int i = 0; i < path.num_data; i += path.data[i].header.length) {
    data += "MLCZ"[path.data[i].header.type];
    for (int point = 1; point < path.data[i].header.length; ++point) {
      const auto& [x, y] = path.data[i + point].point;
      data +=
          (point > 1 ? " " : "") + format_number(x, kDecimals) + " " + format_number(y, kDecimals);
    }
  }
  return data;
}

}  // namespace

bool is_cut(const SheetText& text) {
  const double width = text_width(text.text, text.height);
  return width > 0 && shrink_to(text.max_width, width) < kLeastTextShrink;
}

bool has_glyphs(const std::string& text) {
  const Layout layout = make_layout(text_tools().context.get(), printable_text(text));
  return pango_layout_get_unknown_glyphs_count(layout.get()) == 0;
}

double text_width(const std::string& text, double height) {
  // Drawings are laid out at one scale after the other: each text is measured once.
  constexpr std::size_t kKept = 100'000;
  thread_local std::map<std::string, double> widths;  // with capital letters of height 1
  const auto& [context, capital] = text_tools();
  if (capital <= 0) return 0;
  if (widths.size() == kKept) widths.clear();
  const auto [entry, is_new] = widths.emplace(text, 0);
  if (is_new) {
    entry->second =
        extents_of(make_layout(context.get(), printable_text(text)).get()).width / capital;
  }
  return entry->second * height;
}

std::vector<std::string> lines_of(const std::string& text, double width, double height) {
  std::vector<std::string> lines;
  std::string line;
  for (const std::string& word : split(printable_text(text), ' ')) {
    const std::string longer = line.empty() ? word : fmt::format("{} {}", line, word);
    if (!line.empty() && text_width(longer, height) > width) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

void show_text(cairo_t* context, const SheetText& text, bool as_outlines) {
  const SetText& set = set_text(text);
  if (set.layout == nullptr) return;
  cairo_save(context);
  cairo_translate(context, text.at.x(), text.at.y());
  cairo_rotate(context, -text.angle);
  cairo_scale(context, set.scale, set.scale);
  cairo_move_to(context, start_of(text, set), 0);
  if (as_outlines) {
    pango_cairo_layout_line_path(context, only_line(set));
    cairo_set_fill_rule(context, CAIRO_FILL_RULE_WINDING);
    cairo_fill(context);
  } else {
    pango_cairo_show_layout_line(context, only_line(set));
  }
  cairo_restore(context);
}

std::string text_path(const SheetText& text) {
  const SetText& set = set_text(text);
  if (set.layout == nullptr) return {};
  // Cairo keeps paths in 1/256 of a device unit: the device is made fine enough.
  constexpr double kDeviceScale = 64;
  cairo_surface_t* surface = cairo_recording_surface_create(CAIRO_CONTENT_ALPHA, nullptr);
  cairo_t* context = cairo_create(surface);
  cairo_scale(context, kDeviceScale, kDeviceScale);
  cairo_save(context);
  cairo_translate(context, start_of(text, set), 0);
  pango_cairo_layout_line_path(context, only_line(set));
  cairo_restore(context);
  cairo_scale(context, 0.001 / set.scale, 0.001 / set.scale);  // the path is read in millimetres
  cairo_path_t* path = cairo_copy_path(context);
  std::string data = path_data(*path);
  cairo_path_destroy(path);
  cairo_destroy(context);
  cairo_surface_destroy(surface);
  return data;
}

}  // namespace tagsmith::detail
