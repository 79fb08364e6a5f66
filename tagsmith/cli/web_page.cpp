// SPDX-License-Identifier: Apache-2.0
#include "tagsmith/cli/web_page.hpp"

namespace tagsmith::detail {
namespace {

constexpr const char* kCommon = R"css(
:root { color-scheme: light; --ink: #1b1f24; --grey: #5b6570; --line: #d6dbe0; --paper: #fff;
  --card: #f6f8fa; --ok: #0d7a31; --poor: #a85a00; --faulty: #b01818; --unseen: #6b7580; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 16px; max-width: 1100px; color: var(--ink);
  background: var(--paper); font: 16px/1.45 system-ui, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.35rem; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 1.05rem; margin: 28px 0 8px; }
p { margin: 0 0 8px; }
.sub { color: var(--grey); font-size: .9rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 6px 10px 6px 0; border-top: 1px solid var(--line);
  font-size: .9rem; vertical-align: top; }
th { white-space: nowrap; }
@media print { body { max-width: none; padding: 0; font-size: 11pt; } h2 { break-after: avoid; }
  tr { break-inside: avoid; } }
)css";

constexpr const char* kReport = R"css(
:root { color-scheme: light dark; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ec; --grey: #9aa4ae; --line: #3a424b; --paper: #14181c; --card: #1d2329;
    --ok: #46c06c; --poor: #f0a040; --faulty: #ff6b6b; --unseen: #9aa4ae; } }
.known { margin-top: 8px; overflow-wrap: anywhere; }
.counts { display: flex; flex-wrap: wrap; gap: 8px; margin: 12px 0; }
.counts button { font: inherit; color: inherit; background: var(--card); cursor: pointer;
  border: 1px solid var(--line); border-radius: 8px; padding: 8px 14px; min-height: 44px; }
.counts button[aria-pressed=true] { border-color: currentColor; box-shadow: inset 0 0 0 1px; }
.counts b { font-size: 1.25rem; margin-right: 6px; }
:focus-visible { outline: 3px solid #4c8dff; outline-offset: 2px; }
.cover { display: grid; grid-template-columns: max-content 1fr max-content; gap: 4px 10px;
  align-items: center; max-width: 560px; }
progress { width: 100%; accent-color: var(--ok); }
summary { cursor: pointer; padding: 8px 0; }
ul { margin: 8px 0; padding-left: 20px; }
.map { overflow-x: auto; border: 1px solid var(--line); border-radius: 8px; margin: 0 0 8px; }
.map svg { display: block; width: 100%; min-width: 720px; height: auto; }
.wall { fill: none; stroke: var(--ink); stroke-width: 1.5; }
.axis { fill: none; stroke: var(--grey); stroke-width: .8; stroke-dasharray: 10 3 2 3; }
.tick { stroke: var(--grey); }
svg text { font: 11px system-ui, "DejaVu Sans", sans-serif; fill: var(--grey); }
.tag { cursor: pointer; }
.tag circle, .tag path { fill: currentColor; stroke: var(--paper); stroke-width: 1.5; }
.tag.unseen circle { fill: var(--paper); stroke: currentColor; stroke-width: 2; }
.tag text { fill: currentColor; }
label { display: block; margin: 16px 0 4px; }
input { font: inherit; color: inherit; background: var(--paper); border: 1px solid var(--grey);
  border-radius: 8px; padding: 10px; width: 100%; max-width: 420px; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 320px), 1fr));
  gap: 12px; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 12px;
  content-visibility: auto; contain-intrinsic-size: auto 260px; overflow-wrap: anywhere; }
.card h3 { font-size: 1rem; margin: 0 0 6px; color: var(--faulty); }
.card p { font-size: .9rem; }
.crop { display: block; width: 100%; border: 0; padding: 0; margin: 0 0 8px; background: none;
  cursor: zoom-in; }
.crop img { display: block; width: 100%; max-height: 220px; object-fit: contain;
  background: #80808022; }
.crop[aria-expanded=true] { cursor: zoom-out; } .crop[aria-expanded=true] img { max-height: none; }
.wide { grid-column: 1 / -1; }
.ok { color: var(--ok); } .poor { color: var(--poor); } .faulty { color: var(--faulty); }
.unseen { color: var(--unseen); }
[hidden] { display: none !important; }
@media (max-width: 560px) { .more { display: none; } th, td { padding-right: 6px; } }
@media print {
  :root { color-scheme: light; --ink: #000; --grey: #444; --line: #bbb; --paper: #fff;
    --card: #fff; --ok: #0d7a31; --poor: #a85a00; --faulty: #b01818; --unseen: #666; }
  .screen { display: none; }
  .map, .scroll { overflow: visible; } .map svg { min-width: 0; }
  .cards { grid-template-columns: repeat(3, 1fr); gap: 8px; } .crop img { max-height: 34mm; }
  .card { content-visibility: visible; padding: 8px; } .card h3 { font-size: 10pt; }
  .card p { font-size: 8pt; margin: 0 0 4px; } .card, .map { break-inside: avoid; } }
)css";

}  // namespace

std::string page_head(const std::string& title, const std::string& style, bool has_script) {
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
         "data:; style-src 'unsafe-inline'" +
         std::string(has_script ? "; script-src 'unsafe-inline'" : "") + "\">\n<title>" + title +
         "</title>\n<style>" + kCommon + style + "</style>\n</head>\n<body>\n";
}

std::string page_table(const std::string& head, const std::string& rows) {
  return "<div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>\n" + rows +
         "</tbody></table></div>\n";
}

const char* report_style() { return kReport; }

}  // namespace tagsmith::detail
