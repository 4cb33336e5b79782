#!/usr/bin/env bash
# A ready case in its small size: from nothing to its answers, page, picture and ParaView files, killed half way and resumed. "drum-sweep" is a sweep.
# usage: cases_test.sh RUNNER BIN SCRATCH CASE    "--list" in place of RUNNER prints the cases
set -euo pipefail
cases=(hopper column repose drum conveyor triaxial critical-state compression shear-flow flow-function press mill screen sticky granuheap impact silo crater crush brazilian beam rockfall granite unbroken
  shape-dial dice tube coater mixer shear-box wet-drum staples ballast cuboids heated-drum heated-bed fluidised drum-sweep)
if [[ $1 == --list ]]; then printf '%s;' "${cases[@]}"; exit 0; fi
runner=$1; export SCREE_BIN=$2; scratch=$3/$4
rm -rf "$scratch"; mkdir -p "$scratch"
run() {
  local name=$1; shift
  "$runner" "$name" --out "$scratch/$name" --config size=small ranks=1 "$@" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
}
holds() { grep -q -e "$2" "$scratch/$1" || { echo "'$2' is not in $1:"; cat "$scratch/$1"; exit 1; }; }
there() { for file in "$@"; do [[ -s "$scratch/$file" ]] || { echo "$file is not there, or empty"; exit 1; }; done; }
# of each case one run with a report, a picture and ParaView files
page() { holds "$1.report.html" "</html>"; there "$1.png" "$1.run/paraview/$(basename "$1").pvd"; }
resumes() { "$(dirname "$0")/resume_test.py" "$runner" "$SCREE_BIN" "$scratch" "$scratch/killed" "$1"; }
charts() { there "$1.png" "$1.svg"; }

case $4 in
  hopper)
    run hopper
    holds hopper/discharge.md "Exponent n of W"
    page hopper/hopper-ball-13; resumes hopper/hopper-ball-13 ;;
  column)
    run column
    holds column/runout.md "| column-small | 97 | 6 |"
    page column/column-small; resumes column/column-small ;;
  repose)
    run repose
    holds repose/repose.csv "^repose-ball,"
    page repose/repose-cube; resumes repose/repose-cube ;;
  drum)
    run drum
    holds drum/drum-small.statistics/summary.csv "angle_of_repose"   # thirty stones are too few for a mixing index
    page drum/drum-small; resumes drum/drum-small ;;
  conveyor)
    run conveyor
    holds conveyor/conveyor.md "| load of belt 1 | "
    there conveyor/conveyor.png
    page conveyor/conveyor-small; resumes conveyor/conveyor-small ;;
  coater)
    run coater
    holds coater/coating.md "CV falls as t^-n with n = "
    charts coater/coating
    page coater/coater-small; resumes coater/coater-small ;;
  mixer)
    run mixer
    holds mixer/mixer.md "^| 60 rpm | 0.5 |  | 0\\.[0-9]* |"
    charts mixer/mixer
    # both populations are seen, each in a colour of its own, warm and cold; walls are pale
    /usr/bin/python3 - "$scratch/mixer/mixer-small.png" <<'PYTHON'
import sys
import matplotlib.image
picture = matplotlib.image.imread(sys.argv[1])
warmth = picture[..., 0] - picture[..., 2]
shares = (warmth > 0.08).mean(), (warmth < -0.08).mean()
assert min(shares) > 0.01, f"shares of the picture that are warm and cold: {shares}"
PYTHON
    if command -v ffmpeg >/dev/null; then there mixer/mixer-small.mp4; fi
    page mixer/mixer-small; resumes mixer/mixer-small ;;
  shear-box)
    run shear-box
    holds shear-box/shear-box.md "^| 40 kPa | [1-9][0-9.]* kPa | [1-9][0-9.]* kPa | \(>= [1-9][0-9.]* degrees, largest at the end\|[1-9][0-9.]* degrees\) | [0-9.]* mm | [1-9][0-9.]* degrees | "
    holds shear-box/shear-box.json '"lid_stress": 40000.0,'; holds shear-box/shear-box.json '"is_largest_at_end": \(true\|false\)'
    charts shear-box/shear-box
    page shear-box/shear-box-small-40; resumes shear-box/shear-box-small-40 ;;
  cuboids)
    run cuboids
    # a tile lands on its square faces, a long bar does not; all boxes rest on a face
    holds cuboids/cuboids.md "^| 0\.47 | 0\.916 +- 0\.015 | 332 | \(0\.[7-9]\|1\.0\)[0-9]* +- 0\.[0-9]* | 12 | .* | 0 |$"
    holds cuboids/cuboids.md "^| 2\.65 | 0\.006 +- 0\.004 | 503 | 0\.[01][0-9]* +- 0\.[0-9]* | 12 | .* | 0 |$"
    holds cuboids/cuboids.md "^| cube on its faces across x | 0\.[0-9]* +- 0\.[0-9]* | 1/3 within 1\.96 errors | holds |$"
    holds cuboids/cuboids.md "^| boxes that move or rest on no face | 0 of 192 "
    charts cuboids/cuboids
    holds cuboids/cuboids.report.html "</html>"; there cuboids/cuboids.run/paraview/cuboids.pvd
    resumes cuboids/cuboids ;;
  wet-drum)
    run wet-drum
    # a quarter of a turn: both beds are on their way up
    holds wet-drum/wet-drum.md "^| none | 0.00 | 0 | 0 | [2-5]\\.[0-9]* | [1-9][0-9]\\.[0-9] +- "
    holds wet-drum/wet-drum.md "^| tension-144-volume-0.02 | 4\\.[01][0-9]* | 0\\.02 | 0\\.[0-9]* | [2-7]\\.[0-9]* | [1-9][0-9]\\.[0-9] +- "
    # the bridges of the small bed hold it at any angle: no start is predicted
    holds wet-drum/wet-drum.md "liquid over solid, by volume \\[%\\]"; holds wet-drum/wet-drum.md "^| tension-144-volume-0.02 | .* | none |$"
    holds wet-drum/wet-drum.json '"predicted_start": null'; holds wet-drum/wet-drum.json '"predicted_start": [1-9]'
    charts wet-drum/wet-drum
    page wet-drum/tension-144-volume-0.02; resumes wet-drum/tension-144-volume-0.02 ;;
  staples)
    run staples
    # half a second: both columns go down, no staple is lost, and contacts stay shallow
    holds staples/staples.md "^| arm-0\.1-gamma-3-1 | 3\.00 | .* | 0\.[3-9][0-9] | 0 | 0\.0[0-9]*, 0\.[0-3][0-9]* | [0-9.]*e-0[2-9] |"
    holds staples/staples.md "^| arm-0\.4-gamma-3-1 | 3\.00 | .* | 0\.[3-9][0-9] | 0 | 0\.0[0-9]*, 0\.[0-3][0-9]* | [0-9.]*e-0[2-9] |"
    there staples/staples.json; charts staples/staples
    page staples/arm-0.4-gamma-3-1; resumes staples/arm-0.4-gamma-3-1 ;;
  ballast)
    run ballast
    # the load's work, the height that is lost and the stored energy make up what log.csv has as dissipated
    holds ballast/ballast.md "^| 1 | [0-9]*\\.[0-9]* | [0-9]*\\.[0-9]* | [0-9]*\\.[0-9]* |"
    holds ballast/ballast.md "^| ballast-small-1 | .* | [-+][0-9.]*e-0[2-9] |"
    charts ballast/ballast
    page ballast/ballast-small-1; resumes ballast/ballast-small-1 ;;
  triaxial)
    run triaxial
    holds triaxial/triaxial.md "sheared by"  # pressed, and the page says how far it got
    grep -qE '^\| 50 kPa \| (0\.999[5-9]|1\.000[0-5]) to (0\.999[5-9]|1\.000[0-5]) ' "$scratch/triaxial/triaxial.md" ||
      { echo "triaxial/triaxial.md: the stress is off by more than 5e-4 of that asked"; cat "$scratch/triaxial/triaxial.md"; exit 1; }
    page triaxial/triaxial-small; resumes triaxial/triaxial-small ;;
  flow-function)
    run flow-function
    # what was pressed holds together where contacts yield, and only there
    holds flow-function/flow-function.md "^| balls | 125 | \(20\.0\|19\.9\)[0-9] kPa | 0\.[4-6][0-9] | 0\.[45][0-9]* | [1-3]\.[0-9]* kPa | .* | \([6-9]\|1[0-9]\|20\)\.[0-9] | 1 |$"
    holds flow-function/flow-function.md "^| balls, contacts that do not yield | 125 | \(20\.0\|19\.9\)[0-9] kPa | .* | 0\.0[0-9] kPa | .* | above 100 | 1 |$"
    charts flow-function/flow-function
    page flow-function/ball-20-1; resumes flow-function/ball-20-1 ;;
  critical-state)
    run critical-state
    # dense rocks are stronger than loose ones; the cell holds its stress across to a tenth for forty rocks
    holds critical-state/critical-state.md "^| dense | 50 kPa | 0\.6[5-9][0-9] | 1\.[4-9]"
    holds critical-state/critical-state.md "^| loose | 50 kPa | 0\.5[4-9][0-9] | \(0\.[5-9]\|1\.[0-3]\)"
    holds critical-state/critical-state.md "^Lateral stress over that asked: \(0\.9\|1\.0\)[0-9]* to \(0\.9\|1\.0\|1\.1\)"
    charts critical-state/critical-state
    there critical-state/dense-50-1.run/paraview/cell.pvd
    page critical-state/dense-50-1; resumes critical-state/dense-50-1 ;;
  compression)
    run compression
    holds compression/compression.md "^| balls, no friction | 0\.6[0-6]"   # sixty balls
    holds compression/compression.md "^| cubes, no friction | 0\.[67]"
    charts compression/compression
    page compression/ball-1-at-0.2 ;;
  shear-flow)
    run shear-flow
    # sixty balls, forty rocks and forty pentagons at an inertial number of a tenth, on a shear of 1
    holds shear-flow/shear-flow.md "^| balls, no friction | 0\.1[0-9]* | 0\.[23][0-9]* +- 0\.[01][0-9]* | 0\.6"
    holds shear-flow/shear-flow.md "^| rocks, friction 0.5 | 0\.\(09\|1\)[0-9]* | 0\.[4-7][0-9]* +- 0\.[01][0-9]* | 0\.5"
    holds shear-flow/shear-flow.md "^| pentagons, no friction | 0\.[01][0-9]* | 0\.[1-4][0-9]* +- 0\.[01][0-9]* | 0\.[78]"
    charts shear-flow/shear-flow
    there shear-flow/rock-0.1.run/paraview/cell.pvd
    page shear-flow/ball-0.1; resumes shear-flow/ball-0.1 ;;
  press)
    run press
    # smooth sides: what presses on the lid comes down to the floor. Thirty grains settle anew whenever the lid wears, each 50 ms: 3e-3
    holds press/press.md "| press-small | \(0.99[789][0-9]\|1.00[0-2][0-9]\) | \(0.999[0-9]\|1.000[0-9]\) |"
    holds press/press-small.report.html "Loads on walls"
    there press/press-small.run/wall5_worn.shape.h5
    page press/press-small; resumes press/press-small ;;
  mill)
    run mill
    holds mill/mill.md "178 bodies"
    holds mill/mill-small.report.html "Impacts by energy"
    there mill/mill.png mill/mill-small.statistics/impacts.csv
    page mill/mill-small; resumes mill/mill-small ;;
  screen)
    run screen
    holds screen/screen.md "| coarse, 20 mm | [0-9]* | 0 |"   # none is small enough to pass
    holds screen/screen.md "Mass in, less what left and what is there: \(0.0e+00\|-\?[0-9.]*e-[12][0-9]\) kg"
    there screen/screen.png
    page screen/screen-small ;;
  sticky)
    run sticky
    holds sticky/sticky.md "| ball | 20 | "
    page sticky/sticky-ball-20; resumes sticky/sticky-ball-20 ;;
  tube)
    run tube
    holds tube/tube.md "^| balls | 0.03 | 0.4"; holds tube/tube.md "^| rings | 0.03 | 0.[56]"
    there tube/ball-0.03-1.bed/bed.stl tube/ring-0.03-1.bed/void_fraction.vti; charts tube/tube
    page tube/ring-0.03-1; resumes tube/ring-0.03-1 ;;
  granuheap)
    run granuheap
    holds granuheap/granuheap.md "^| 0.01 | [0-9]* | "
    page granuheap/granuheap-1e-2 ;;
  impact)
    run impact
    holds impact/impact.md "| impact-250 | Scree | 0.0 |"
    there impact/impact.png impact/bed-250.run/run.json
    page impact/impact-250
    run impact grain=ico80
    holds impact/impact.md "| impact-250-ico80 | Scree | 0.0 |" ;;
  silo)
    run silo
    holds silo/silo.md "| silo-large | [1-9][0-9]* | [1-9]"   # balls come out, at a rate
    page silo/silo-large; resumes silo/silo-large ;;
  crater)
    run crater
    holds crater/crater.md "^| density-7800 | 10[0-9.]* | 7800 | [2-5][.]"   # it goes in, and not to the floor
    there crater/crater.png
    page crater/density-7800 ;;
  crush)
    run crush
    holds crush/crush.md "^| 3 | 3 | "   # all three split
    grep -q "^| 3 | 4.5 | 1.000 |" "$scratch/crush/crush.md" || { cat "$scratch/crush/crush.md"; exit 1; }   # 4.5 J/kg leaves no cell at another
    charts crush/crush
    page crush/press-01 ;;
  brazilian)
    run brazilian
    holds brazilian/brazilian.md "stress along the load | -[23]"
    charts brazilian/brazilian
    page brazilian/split ;;
  beam)
    run beam
    holds beam/beam.md "^| 40 cells, tangential_ratio 1 | 1 | 0.9[5-9]"   # cells two across hardly shear: near Euler and Bernoulli
    holds beam/beam.md "modulus of rupture over the tension of a bond | 0\.[5-8]"
    charts beam/beam
    page beam/bend-1 ;;
  rockfall)
    run rockfall
    holds rockfall/rockfall.md "^| boulder-1 | "
    charts rockfall/rockfall
    page rockfall/boulder-1; resumes rockfall/boulder-1 ;;
  granite)
    run granite
    holds granite/granite.md "^| cells, calibrated, 1 cut, not failed | [5-9][0-9]\.[0-9] | 0\.[1-3]"   # Young's modulus near 69 GPa, Poisson's ratio near 0.26
    charts granite/granite
    page granite/compress-1 ;;
  unbroken)
    run unbroken
    holds unbroken/unbroken.md "^| cut | [0-9]* | [0-9]* | [0-9.e-]* | 0.000 | 0 |"   # nothing breaks
    charts unbroken/unbroken
    page unbroken/cut-1 ;;
  shape-dial)
    run shape-dial
    holds shape-dial/dial.csv "^ball-rolling-0.3,"
    there shape-dial/dial.png
    page shape-dial/dial-hull; resumes shape-dial/dial-hull ;;
  dice)
    run dice
    holds dice/dice.md "| cube | 0\.[56][0-9]* | 0\.54 |"   # looser or denser is no bed of cubes
    # rigid dice at rest have six constraints at least; more contacts are of faces where gaps count
    holds dice/dice.md "^| cube | 0 | 0\.[56][0-9]* | \([6-9]\|1[0-9]\)\.[0-9] | \([7-9]\|[12][0-9]\)\.[0-9] | "
    there dice/dice.png
    resumes dice/cube-1 ;;
  heated-drum)
    run heated-drum
    # a third of a turn gives no heating time; what is stored came from the wall, to rounding
    holds heated-drum/heated-drum.md "^| heat stored, less what the wall gave, over it | \(0.0e+00\|[0-9.]*e-1[0-9]\) |"
    charts heated-drum/heated-drum
    if command -v ffmpeg >/dev/null; then there heated-drum/heated-rock.mp4; fi
    page heated-drum/heated-rock; resumes heated-drum/heated-rock ;;
  fluidised)
    /usr/bin/python3 -c "import dolfinx" 2>/dev/null || { echo "dolfinx is not installed: ./setup --fluid"; exit 77; }
    run fluidised
    holds fluidised/ergun.md "pressure gradient at 1.0 m/s"
    there fluidised/fluidised-ball.csv fluidised/fluidised-rock.csv fluidised/fluidised.png
    # hot air: closed forms, and the energy of both codes
    holds fluidised/warm.md "^| Schumann, cells of 1.6 mm: largest error of balls and air"
    for shape in ball rock; do holds "fluidised/warm-$shape.energy.md" "^| exchange: heat that left the air, with what it owes | [0-9.]* | heat that the bodies took | [0-9.]* | [-+][0-9.]*e\(+00\|-1[0-9]\) |"; done
    there fluidised/warm-ball.csv fluidised/warm-rock.profiles.csv fluidised/warm.png
    if command -v ffmpeg >/dev/null; then there fluidised/fluidised-ball.mp4 fluidised/fluidised-rock.mp4 fluidised/warm-ball.mp4; fi
    page fluidised/fluidised-ball; page fluidised/warm-rock ;;
  heated-bed)
    run heated-bed
    # too low a bed for the depths of the experiment; what is stored came from the lid, to rounding
    holds heated-bed/heated-bed.md "- heated-air: 120 balls.* heat stored less heat from the lid [0-9.]*e-1[0-9] of it$"
    there heated-bed/heated-bed.png heated-bed/bed.run/run.json
    page heated-bed/heated-air; resumes heated-bed/bed ;;   # the heated bed itself takes a fifth of a second
  drum-sweep)
    # two frictions and two seeds: four runs, one table, and the seed matters
    run drum "sweep=pairs.*.friction=0.2|0.6;time.duration=20 ms" replicas=2 plot=mean_speed
    [[ $(wc -l <"$scratch/drum/sweep.csv") -eq 5 ]] || { cat "$scratch/drum/sweep.csv"; exit 1; }
    [[ $(cut -d, -f9 "$scratch/drum/sweep.csv" | sort -u | wc -l) -gt 2 ]] || { echo "seeds change nothing"; exit 1; }
    # one row for each friction: two seeds, their mean, and half of its interval
    awk -F, 'NR == 1 { for (k = 1; k <= NF; ++k) if ($k == "centre_of_mass_z_mean") m = k } NR > 1 { if ($4 != 2 || !($m > 0) || !($(m + 1) > 0)) exit 1 } END { if (NR != 3 || !m) exit 1 }' \
      "$scratch/drum/sweep_means.csv" || { cat "$scratch/drum/sweep_means.csv"; exit 1; }
    there drum/sweep.png
    if "$runner" drum --out "$scratch/bad" --dry-run --config "sweep=friction" >"$scratch/log" 2>&1; then echo "a sweep without values was accepted"; exit 1; fi
    holds log "expected KEY=VALUE|VALUE" ;;
  *) echo "unknown case '$4'; there are: ${cases[*]}"; exit 2 ;;
esac
rm -rf "$scratch"
