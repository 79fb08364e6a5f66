// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/survey/rules.hpp"

#include <algorithm>
#include <array>

namespace tagsmith::detail {
namespace {

// By code.
constexpr std::array kRules{
    Rule{"alike-codes", "codes of neighbours differ by likely misreadings alone",
         "Blur and dirt turn 1 into 7 and 2 into 8 more easily than other digits. Two "
         "tags within 20 m of each other whose codes differ in such digits only are the "
         "pair that a bad photo could confuse. Another code.origin moves the digits; "
         "check_digit: gs1 weighs them differently."},
    Rule{"bad-allow", "a comment that allows nothing known",
         "A comment `# tagsmith: allow RULE: REASON` silences the warnings of one rule "
         "on its own line, or on the next one when it has a line to itself. It must name "
         "a rule and give a reason; errors cannot be allowed."},
    Rule{"bad-choice", "a word that is none of the allowed ones",
         "The key takes one of a few words; the finding lists them."},
    Rule{"bad-crs", "a coordinate reference system that the grid cannot have",
         "grid.crs names the mine's grid by its number in the EPSG register, as EPSG:25832, so "
         "that exported maps lie where they belong. It is a grid in metres, x to the east and y "
         "to the north; systems in degrees and grids with x to the left are none."},
    Rule{"bad-date", "a date that is none", "Dates are written year, month, day: 2026-03-31."},
    Rule{"bad-digit-counts", "the digits of x, y and z do not sum to eleven",
         "A symbol has eleven digits and a check digit. code.digits shares the eleven "
         "out among x, y and z: three whole numbers of at least 1."},
    Rule{"bad-digits", "digits that are no code",
         "Printed digits are text in quotes: eleven digits, or twelve with the check "
         "digit. As a number they would lose their leading zeros."},
    Rule{"bad-dxf", "a drawing that is no ASCII DXF",
         "A DXF has group codes and values, a line each. This file has a line where a group code "
         "should be and none is: save the drawing again."},
    Rule{"bad-element", "an element of the center line that is neither line, arc nor clothoid",
         "Each element is { line: LENGTH }, { arc: RADIUS, turn: left|right, angle: DEGREES } or "
         "{ clothoid: LENGTH, turn: left|right, from_radius: RADIUS, to_radius: RADIUS }, of which "
         "one radius may be left out for a straight end, with an optional grade in percent."},
    Rule{"bad-gsi", "a word that is none of Leica GSI",
         "A word has six characters of index, information and unit, a sign, and 8 or in lines that "
         "begin with * 16 characters of data."},
    Rule{"bad-name", "a name that cannot name files or columns",
         "Names become file names and columns of tables: they begin with a letter or "
         "digit and have no / \\ , : or quotes. Cameras and ranges take letters, digits, "
         "- and _ only."},
    Rule{"bad-number", "a field that is no number",
         "Point lists have numbers with decimal points in the columns that --order "
         "declares; --header says that the first line names the columns."},
    Rule{"bad-quotes", "quotes in a table that do not match",
         "A field in quotes ends with a quote before the next comma; a quote inside it "
         "is written twice."},
    Rule{"bad-station", "stations of walls or sections that are not in order",
         "Sections and wall points run along the drive: chainages do not fall. Two at one chainage "
         "are a step, the value before it first."},
    Rule{"bad-tag-name", "a tag's name that is no pair and side",
         "Tags are named by the pair in at least three digits and L or R of the drive: "
         "000L, 012R, 1234L."},
    Rule{"bad-text", "text that is empty, too long or has control characters",
         "Text is one line of at most 200 bytes of UTF-8, without control characters and "
         "without those that turn the direction of writing, which make a name look like "
         "another."},
    Rule{"board-scale", "a calibration board that was printed too large or too small",
         "What was measured from cross to cross is more than 2 % off what was drawn, or the two "
         "directions differ by more than 1 %. Mostly a printer scaled the sheet to the page, or "
         "one distance was misread."},
    Rule{"calibration-file", "a calibration file that cannot be read",
         "The path is relative to the rig file; the file is at most some megabytes."},
    Rule{"calibration-size", "a calibration of another image size",
         "A calibration holds for images of the size it was made with, and for no other. "
         "Calibrate with the images that the vehicle takes."},
    Rule{"camera-matrix", "a camera matrix of no pinhole",
         "The matrix is [fx, 0, cx; 0, fy, cy; 0, 0, 1]. Skewed pixels are not "
         "supported; a transposed matrix must be turned."},
    Rule{"coarse-code", "the code rounds positions more than the survey does",
         "Whoever reads a tag without the survey knows its position to the code's "
         "resolution only. The survey's own positions are used wherever it is at hand. A "
         "finer code.resolution rounds less and reaches less far."},
    Rule{"code-collision", "two tags with one code",
         "A code must lead to one tag, also over all surveys given to one command: "
         "otherwise the vehicle is put at the wrong one. Another code.origin, or the "
         "other check digit, keeps surveys apart."},
    Rule{"code-range", "a position that the code cannot say",
         "Each axis has code.digits digits of code.resolution, from code.origin on. The "
         "remedy says which origin would bring all tags into range."},
    Rule{"code-range-end", "positions close to the end of the code's range",
         "The last twentieth of an axis is in use: the next section of the drive will "
         "not fit. Plan its digits now, since codes that are printed stay."},
    Rule{"complex-key", "a key that is no word",
         "YAML allows lists and maps as keys; these files do not."},
    Rule{"conflicting-keys", "keys that exclude each other",
         "Two keys say the same thing in different ways. Keep the one that is meant."},
    Rule{"corner-radius", "rounded corners larger than the plate",
         "The radius of the plate's corners is at most half its shorter side."},
    Rule{"decimal-comma", "a comma as decimal sign",
         "The decimal sign is a point; a comma separates the items of a list."},
    Rule{"duplicate-column", "a column of a table twice",
         "Each column may stand once in the first line."},
    Rule{"duplicate-id", "an id of a table twice", "Results are told apart by the id."},
    Rule{"duplicate-key", "a key or name twice",
         "YAML readers differ on which of two equal keys counts; so neither does here."},
    Rule{"duplicate-survey", "two surveys of one name",
         "Labels, manifests and results name the survey. Surveys that are given together "
         "need names of their own."},
    Rule{"duplicate-tag", "a placed tag twice",
         "Each tag has one position. Keep the one that was measured last."},
    Rule{"empty-file", "a file without content", "The file has no keys or no rows."},
    Rule{"exchanged-axes", "x and y of the placed tags, or of a point, are exchanged",
         "Hardly any tag lies at its wall, but nearly all do with x and y exchanged. "
         "Many instruments list north (y) before east (x). In a list of points one point that "
         "lies far from the others, and among them with its two coordinates exchanged, is named "
         "alone."},
    Rule{"exchanged-code", "digits that say where another tag hangs",
         "The code identifies a tag and says roughly where it hangs. Digits that say the "
         "place of another tag, of this survey or of one given together with it, mostly "
         "come from two plates or two lines that were exchanged; without the survey such "
         "a tag gives a wrong place. Silent where the code's resolution cannot tell the "
         "two places apart."},
    Rule{"faces-rock", "a plate with an attitude of its own that looks at a wall",
         "Nobody can see a plate that faces the rock. facing is the direction that its face looks "
         "to, from +y towards +x of the grid; the reading of an instrument sighted at the plate is "
         "the opposite one."},
    Rule{"frame-outside-plate", "the feature frame is larger than the plate",
         "The frame with its stroke and offset must lie on the plate."},
    Rule{"height-outlier", "a tag higher or lower than the others",
         "Compared with the design, or with three tags on either side of its wall. Where "
         "one slip of the pen explains it, the finding says so. A tag that does hang "
         "there is allowed with a comment."},
    Rule{"height-slip", "a surveyed point above or below what its neighbours say",
         "Of each kind of point of a list, the line through the six nearest says how high each "
         "one should be. This one is off by more than eight times the scatter of its kind and "
         "30 mm: a slip in the height of the staff or of the instrument, or in one digit."},
    Rule{"hole-misplaced", "a drill hole where it must not be",
         "Holes lie on the plate, clear of the feature frame, the label and the edge."},
    Rule{"leading-zero", "a number with leading zeros",
         "Some programs read 012 as octal ten. Write 12."},
    Rule{"left-out", "parts of a drawing that were not read",
         "Of a drawing only points, lines, polylines and blocks are read, on layers whose names "
         "are descriptions of points."},
    Rule{"lens-model", "a lens model that is not clear",
         "Four distortion coefficients may be those of a perspective lens or of a "
         "fisheye: `model` in the rig's camera says which. Thin-prism and tilt terms are "
         "not supported."},
    Rule{"lens-reach", "a distortion that folds back inside the image",
         "What is seen beyond the fold cannot be used. Calibrate with the target in the "
         "image's corners as well."},
    Rule{"likely-slip", "coordinates that one slip of the pen explains",
         "The tag is off its wall; with two digits exchanged, the sign changed, the "
         "decimal point moved or x and y exchanged it would hang where it is expected."},
    Rule{"long-flow", "very long brackets",
         "Lists of thousands of items are written one item a line, each after a dash: "
         "that is read in a tenth of the memory."},
    Rule{"merge-key", "the merge key <<",
         "Merge keys belong to no YAML standard that programs agree on. Write the keys "
         "out."},
    Rule{"mirrored-grid", "the mirror image of the grid fits",
         "Hardly any tag lies at its wall, but nearly all do when the x axis points to "
         "the other side. grid.x_axis is right when x grows to the right of somebody "
         "looking along +y, and left otherwise. Or left and right were exchanged in the "
         "list."},
    Rule{"missing-column", "a column that a table needs",
         "The first line of the table names the columns; formats.md lists them."},
    Rule{"missing-key", "a key that a file needs", "The finding shows how to write it."},
    Rule{"missing-value", "a value without its partner",
         "Some columns come together: a tag and its distance, the three coordinates of "
         "the truth."},
    Rule{"mixed-colours", "surveys with plates white on black and black on white together",
         "A picture is read for plates of one kind. Read, verify and localize with the surveys of "
         "one kind at a time."},
    Rule{"no-bars", "no height left for the bars",
         "The margin takes all of the inner height of the feature frame."},
    Rule{"no-dots", "a module narrower than a printer's dot",
         "A longer inner frame or a finer printer."},
    Rule{"no-label-room", "no room for a label",
         "People find a plate by its label. Outside the feature frame there is no strip "
         "high enough for letters of a millimetre."},
    Rule{"no-logo", "a logo's file that is not there",
         "logo.file is the name of an SVG file; it is relative to the template's folder."},
    Rule{"no-points", "a point list without points", "The file has no lines but the first."},
    Rule{
        "no-room-for-logo", "no room for the logo",
        "It stands below the feature frame, left of QR symbol and patches. A smaller size_mm, or a "
        "frame that is moved up by feature_frame.offset."},
    Rule{"no-room-for-patches", "no room for the reference patches",
         "They stand below the feature frame. Smaller patches, a smaller frame or a "
         "higher plate."},
    Rule{"no-room-for-qr", "no room for the QR symbol",
         "It stands below the feature frame, left of the patches. A smaller size_mm, or a frame "
         "that is moved up by feature_frame.offset."},
    Rule{"no-template", "a template that is not found",
         "A template is named by its name, and then lies beside the survey or among the "
         "tool's own, or by a path that ends in .yaml."},
    Rule{"no-units", "a list in a unit that is not clear",
         "The file says feet, but international and US survey feet differ by 11 m in 5 000 km; or "
         "it says another unit than --units; or points of one file differ in their unit."},
    Rule{"not-finite", "no finite number", "Infinity and nan are no measurements."},
    Rule{"not-utf-8", "bytes that are no text",
         "Save the file as UTF-8. A file from a word processor or a spreadsheet is no "
         "text."},
    Rule{"odd-focal-length", "a focal length that sees half the world",
         "Focal lengths are in pixels here. A value in millimetres is the usual slip."},
    Rule{"odd-pixels", "pixels that are far from square",
         "The focal lengths in x and y differ by more than 5 %. Cameras with such pixels "
         "exist, but a mistyped sensor size is likelier."},
    Rule{"odd-principal-point", "a principal point far from the image's middle",
         "It is usually within a tenth of the image's size. Check cx and cy, and that "
         "they belong to this image size."},
    Rule{"off-millimetre", "tags of a board that stand on no whole millimetres",
         "The codes of a calibration board say places in millimetres. Tags that stand elsewhere "
         "were not drawn by tagsmith board."},
    Rule{"off-wall", "a placed tag off its wall",
         "P is more than 0.1 m behind the wall's plane (an error: in the rock), or in "
         "front of it (a warning: a niche the other way, a pillar). Check p, "
         "tunnel.width and the center line."},
    Rule{"one-camera", "a name where the file holds one camera",
         "Remove `camera` from the rig's `calibration`."},
    Rule{"out-of-range", "a number outside its range", "The finding says what is expected."},
    Rule{"outside-sheet", "tags that stick out of their board",
         "Frames lie on the sheet with their strokes. One of tags.first, tags.step, the counts and "
         "sheet is mistyped."},
    Rule{"outside-tunnel", "a plate that sticks out of the tunnel",
         "Below the floor, above the roof, before the start or beyond the end of the "
         "center line."},
    Rule{"overlap", "two plates on one spot",
         "Plates of one wall overlap. Check both positions, or spacing."},
    Rule{"pair-shift", "plates of a pair that stand apart otherwise than the others",
         "The right plate of a pair stands as much further along the drive as tags.theta "
         "says; without it plates face each other. The method of Xu et al. (2017) counts "
         "on it."},
    Rule{"part-of-image", "a calibration of a part of the image",
         "The camera was calibrated with binning or a region of interest. Calibrate with "
         "the images that the vehicle takes."},
    Rule{"several-alignments", "a file with several center lines",
         "A survey has one center line. Leave the other alignments out by their names, with "
         "--ignore."},
    Rule{"several-cameras", "a calibration file of several cameras",
         "The rig says which: calibration: { file: FILE, camera: NAME }."},
    Rule{"several-documents", "several YAML documents in one file", "One file, one survey."},
    Rule{"side-mismatch", "a name and a side that contradict each other",
         "Names end in L on the left wall of the drive and in R on the right one."},
    Rule{"small-theta", "theta too small for the paper's method",
         "The closed form of Xu et al. (2017) turns an error of the measured distance "
         "into one 1/tan(theta) times as large along the drive. The joint method does "
         "not depend on theta."},
    Rule{"spacing-outlier", "a tag away from where its neighbours say",
         "Compared with the design, or with three tags on either side of its wall. A "
         "published list of tags once carried 147.19 for 174.19: where one slip of the "
         "pen explains the difference, the finding says which. A tag that does hang "
         "there is allowed with a comment."},
    Rule{"syntax", "no valid YAML",
         "Mostly an indentation, a bracket, a quote or a colon on this line or the one "
         "before."},
    Rule{"tags-overlap", "tags of a board that lie on each other",
         "From tag to tag it is at least a feature frame with its strokes. One of tags.step and "
         "feature_frame is mistyped."},
    Rule{"theta", "a pair angle that cannot be meant, or that moves the right plates",
         "Plates that face each other have tan(theta) = L_CI / W_T. Another theta moves "
         "the right plates along the drive, which some designs want and most do not."},
    Rule{"tight-arc", "an arc tighter than the tunnel is wide",
         "The radius is that of the center line; the inner wall needs one above zero "
         "too."},
    Rule{"too-deep", "nested too deeply", "The formats need five levels at most."},
    Rule{"too-many-points", "more points than are read", "A list has at most a million points."},
    Rule{"too-many-tags", "more tags than one survey may have", "Split the survey."},
    Rule{"too-many-values", "more values than a file may have", "Split the file."},
    Rule{"unknown-camera", "a camera that the calibration file does not have",
         "The finding lists those it has."},
    Rule{"unknown-code", "a description of a point that nobody reads",
         "The finding lists the known ones; --ignore leaves points out."},
    Rule{"unknown-column", "a column that nobody reads",
         "A misspelt column would be ignored silently otherwise."},
    Rule{"unknown-field", "a field of a label or a QR symbol that is none",
         "Words in braces stand for what each tag has: {name}, {side}, {digits}, {chainage}, {x}, "
         "{y}, {z}, {survey} and {revision}."},
    Rule{"unknown-format", "a calibration file of no known format",
         "OpenCV's YAML and XML, ROS camera_info and kalibr's camchain are read."},
    Rule{"unknown-key", "a key that nobody reads",
         "A misspelt key would be ignored silently otherwise."},
    Rule{
        "unseen-tag", "a tag that the rig's cameras cannot see",
        "With --rig the vehicle is driven along the center line, at the edges of its envelope too. "
        "No camera has all that the tag's frame encloses in its image anywhere, large enough to be "
        "read. Another tags.height, a plate that looks elsewhere, a larger one, or another camera "
        "helps; tagsmith plan shows what each does."},
    Rule{"unused-allow", "a comment that allows what is not warned of",
         "What it was written for has been mended, or the comment stands on another "
         "line."},
    Rule{"wall-step", "a plate over a step of its wall",
         "Where the section changes at once, a flat plate hangs free on one side. Steps of more "
         "than "
         "2 cm within the plate's length are named."},
    Rule{"wrong-check-digit", "a check digit that does not fit",
         "The twelfth digit follows from the other eleven, by code.check_digit. One "
         "digit is mistyped, or the plate follows the other scheme."},
    Rule{"wrong-kind", "a survey, rig, template or board in the place of another",
         "The file's first key says what it is: survey, rig, tag or board. The finding says where "
         "such a file belongs."},
    Rule{"wrong-length", "a list or row of another length",
         "The finding says how many items are expected. A decimal comma makes two items "
         "of one."},
    Rule{"wrong-side", "a placed tag on the other side of the drive",
         "The side in the tag's name and its position contradict each other. Check the "
         "side, the order of x and y, and grid.x_axis."},
    Rule{"wrong-type", "a value of another kind",
         "Numbers stand alone, without unit and quotes; text that looks like a number "
         "needs quotes."},
    Rule{"yaml-tag", "an explicit YAML tag", "Tags such as !!str are not needed and not read."},
};

static_assert(std::ranges::is_sorted(kRules, {}, &Rule::code));

}  // namespace

std::span<const Rule> rules() { return kRules; }

const Rule* find_rule(std::string_view code) {
  const auto found = std::ranges::lower_bound(kRules, code, {}, &Rule::code);
  return found != kRules.end() && found->code == code ? &*found : nullptr;
}

}  // namespace tagsmith::detail
