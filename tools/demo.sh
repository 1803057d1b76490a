# Plans two real parts and says where the results are. Sourced by ../dev.
build isopath_app

# plan_part NAME WHAT ARGUMENTS...: one run of the program, and one line of its figures.
plan_part() {
  local name=$1 what=$2
  shift 2
  echo
  echo "$what"
  echo "  isopath plan $* -o out/$name"
  build/isopath plan "$@" -o "out/$name" >/dev/null
  python3 - "out/$name/summary.json" <<'PYTHON'
import json, sys
s = json.load(open(sys.argv[1], encoding="utf-8"))
print(f"  {100 * s['covered_fraction']:.2f} % covered by {s['cover_length'] / 1000:.1f} m of passes {s['spacing']:g} mm apart, "
      f"99 % of the area within {s['gap']['p99']:.2f} spacings, {s['lifts']} lifts, "
      f"planned in {s['time_s']['total']:.1f} s")
PYTHON
  reports+=("$PWD/out/$name/report.html")
}

reports=()
plan_part blade "A turbine blade (10 x 129 units, taken as cm), spray coated in one spiral from end to end" \
  data/turbine_blade.off --unit cm --source boundary:0 --pattern spiral --spacing 40 \
  --process spray --stand-off 150 --feed 12000 --post yaml --post csv
plan_part mech_part "A free-form part with four openings (1 unit, taken as 1 m), milled in one closed curve without a lift" \
  data/mech_part_holes.off --unit m --pattern two-way --spacing 30 \
  --process mill --tool ball:50 --feed 6000 --post yaml --post csv

echo
echo "Open the reports in a browser; they need no network:"
printf '  %s\n' "${reports[@]}"
