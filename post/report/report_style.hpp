// The look of report.html: one column, system fonts, colours that also differ in brightness; prints well.
#pragma once

namespace scree {

inline constexpr const char* kReportStyle = R"CSS(
:root { --ink: #1c2430; --soft: #56616f; --line: #d9dfe6; --page: #ffffff; --tint: #f4f6f9; --accent: #0072B2; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--tint); color: var(--ink); font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Liberation Sans", sans-serif; }
main { max-width: 960px; margin: 0 auto; padding: 40px 48px 64px; background: var(--page); min-height: 100vh; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 .3em; }
h2 { font-size: 1.35rem; margin: 2.4em 0 .8em; padding-bottom: .25em; border-bottom: 2px solid var(--line); }
h3 { font-size: 1rem; margin: 1.6em 0 .5em; }
.kicker { margin: 0 0 .3em; color: var(--soft); }
.lead { margin: 0; color: var(--soft); }
nav { margin-top: 1.2em; display: flex; flex-wrap: wrap; gap: .3em 1.1em; }
nav a { color: var(--accent); text-decoration: none; }
nav a:hover { text-decoration: underline; }
code, pre, .hash { font-family: ui-monospace, "DejaVu Sans Mono", "Liberation Mono", Menlo, monospace; font-size: .86em; overflow-wrap: anywhere; }
pre { background: var(--tint); border: 1px solid var(--line); border-radius: 6px; padding: 12px 14px; white-space: pre-wrap; }
.verdicts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(390px, 100%), 1fr)); gap: 14px; }
.verdict { display: flex; gap: 14px; padding: 14px 16px; border: 1px solid var(--line); border-left-width: 6px; border-radius: 6px; }
.verdict h3 { margin: 0; font-size: .92rem; color: var(--soft); font-weight: 600; }
.verdict .answer { margin: 0; font-size: 1.12rem; font-weight: 600; }
.verdict .word { display: inline-block; margin-left: .4em; padding: 0 .5em; border-radius: 9px; font-size: .74rem; font-weight: 600; vertical-align: 2px; white-space: nowrap; }
.verdict .evidence { margin: .3em 0 0; font-size: .86rem; color: var(--soft); overflow-wrap: anywhere; }
.verdict .sign { flex: none; width: 28px; height: 28px; border-radius: 50%; color: #fff; font-weight: 700; text-align: center; line-height: 28px; }
.good { border-left-color: #00795a; } .good .sign { background: #00795a; } .good .word { background: #d8f0e8; color: #00523d; }
.doubtful { border-left-color: #b36b00; } .doubtful .sign { background: #b36b00; } .doubtful .word { background: #fdeccd; color: #6e4200; }
.bad { border-left-color: #b3261e; } .bad .sign { background: #b3261e; } .bad .word { background: #fadcd9; color: #7d150f; }
.information { border-left-color: #5b6b7d; } .information .sign { background: #5b6b7d; } .information .word { background: #e6ebf0; color: #37424e; }
table { border-collapse: collapse; }
.facts th { text-align: left; font-weight: 600; color: var(--soft); padding: 4px 20px 4px 0; vertical-align: top; white-space: nowrap; }
.facts td { padding: 4px 0; overflow-wrap: anywhere; }
.grid-table { width: 100%; font-size: .92rem; }
.grid-table th { text-align: left; color: var(--soft); font-weight: 600; border-bottom: 1px solid var(--line); padding: 5px 12px 5px 0; }
.grid-table td { border-bottom: 1px solid var(--line); padding: 5px 12px 5px 0; }
.n { font-variant-numeric: tabular-nums; }
.matrix td { padding: 1px 14px 1px 0; font-variant-numeric: tabular-nums; }
figure { margin: 0 0 26px; }
.picture img { width: 100%; height: auto; display: block; border: 1px solid var(--line); border-radius: 6px; }
figcaption { color: var(--soft); font-size: .88rem; margin-top: .5em; }
.chart svg { width: 100%; max-width: 760px; height: auto; display: block; font-family: inherit; }
.chart-title { font-size: 15px; font-weight: 600; fill: #1c2430; }
.chart-text { font-size: 12.5px; fill: #37424e; }
.tick { font-size: 11.5px; fill: #56616f; }
.grid { stroke: #e4e9ee; stroke-width: 1; }
.axis { stroke: #6b7785; stroke-width: 1; fill: none; }
.limit { stroke: #b3261e; stroke-width: 1.2; stroke-dasharray: 6 4; }
.limit-text { font-size: 11.5px; fill: #8c1d17; }
.missing { color: var(--soft); background: var(--tint); padding: 12px 14px; border-radius: 6px; }
.chain { list-style: none; padding: 0; }
.chain li { margin: 0 0 .9em; padding-left: 12px; border-left: 3px solid var(--line); font-size: .92rem; overflow-wrap: anywhere; }
.hash { color: var(--soft); }
.view canvas { width: 100%; height: min(64vh, 560px); display: block; border: 1px solid var(--line); border-radius: 6px; background: #f4f6f9; touch-action: none; cursor: grab; }
.view canvas:focus-visible { outline: 2px solid var(--accent); }
.legend { display: flex; flex-wrap: wrap; gap: .2em 1.1em; margin: .6em 0; font-size: .86rem; color: var(--soft); }
.legend i { display: inline-block; width: 18px; height: 12px; margin-right: .4em; border-radius: 3px; vertical-align: -1px; }
.tools { display: flex; flex-wrap: wrap; gap: .5em 1.1em; align-items: center; font-size: .92rem; }
.tools button, .tools select { font: inherit; padding: .25em .7em; border: 1px solid var(--line); border-radius: 6px; background: #fff; color: inherit; }
.tools label, .cut-tools, .player label { white-space: nowrap; }
.zoom { display: inline-flex; gap: .5em; }
.cut-tools { display: inline-flex; align-items: center; gap: .6em; max-width: 100%; } .cut-tools input { flex: 1 1 4em; min-width: 4em; } .cut-tools[hidden], .player[hidden] { display: none; }
.cut-tools output { min-width: 6.5em; font-variant-numeric: tabular-nums; }
.player { display: flex; flex-wrap: wrap; gap: .4em 1em; align-items: center; margin: .6em 0 0; font-size: .92rem; }
.player button, .player select { font: inherit; padding: .25em .7em; border: 1px solid var(--line); border-radius: 6px; background: #fff; color: inherit; }
.player button { min-width: 6.2em; } .player input { flex: 1 1 12em; min-width: 9em; } .player output { min-width: 13em; font-variant-numeric: tabular-nums; }
.legend .scale { width: 64px; }
.note { font-size: .88rem; color: var(--soft); }
.panel { min-height: 3.1em; font-size: .92rem; background: var(--tint); border: 1px solid var(--line); border-radius: 6px; padding: 8px 12px; overflow-wrap: anywhere; }
.wide { overflow-x: auto; }
.state { font-size: .82rem; color: #00523d; white-space: nowrap; } .state.spoilt { color: #7d150f; } .state.lost { color: #6e4200; }
.chart figcaption a { color: var(--accent); }
details { margin-top: 1.4em; } summary { cursor: pointer; color: var(--accent); }
@media (max-width: 720px) { main { padding: 24px 18px; } .verdicts { grid-template-columns: 1fr; } .facts th { white-space: normal; } .grid-table { display: block; overflow-x: auto; } .chart .tick, .chart .limit-text { font-size: 16px; } .chart .chart-text { font-size: 17px; } .chart .chart-title { font-size: 20px; } .view canvas { height: 46vh; } }
@media print { body { background: #fff; } main { max-width: none; padding: 0; } nav, .tools, .player, #view-panel, .chart figcaption { display: none; } .view canvas { height: 12cm; } .wide { overflow: visible; } figure, .verdict { break-inside: avoid; } }
)CSS";

}  // namespace scree
