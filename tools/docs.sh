# Runs the program again for the pictures in docs/img. Sourced by ../dev.
build isopath_app

out=build/docs
picture() { # NAME RUN screenshot options...
  local name=$1 run=$2
  shift 2
  node tools/screenshot.mjs "$out/$run/report.html" "docs/img/$name.png" --size 720x480 --only-part "$@"
  echo "docs/img/$name.png"
}
plan() { # RUN arguments...
  local run=$1
  shift
  build/isopath plan "$@" -o "$out/$run" --post csv --quiet >/dev/null
}

mkdir -p docs/img "$out"
part=(data/mech_part_holes.off --unit m --process mill --tool ball:50)
plan spiral "${part[@]}" --source boundary --pattern spiral --spacing 40
plan contour "${part[@]}" --source boundary --pattern contour --spacing 80
plan meander "${part[@]}" --source plane:0,0,1,0 --pattern meander --spacing 40
plan two_way "${part[@]}" --source boundary --pattern two-way --spacing 60
plan planar "${part[@]}" --pattern planar --direction 1,0,0 --spacing 40
plan blade data/turbine_blade.off --unit cm --source boundary:0 --pattern spiral --spacing 40 --process spray --stand-off 150

corners=(data/patch_100mm_a.off --source boundary --pattern spiral --spacing 5)
plan smooth_off "${corners[@]}" --blend-form none
plan smooth_on "${corners[@]}" --smooth 5

picture part_with_path spiral --hide tool
picture distance_and_isolines contour --hide tool,path,arrows --show isolines
picture gap_of_distance_field spiral --color gap --hide tool,path,arrows
picture gap_of_parallel_planes planar --color gap --hide tool,path,arrows
picture meander meander --hide tool
picture two_way two_way --hide tool,arrows
picture spray_path blade
picture smooth_off smooth_off --view top --hide tool,arrows
picture smooth_on smooth_on --view top --hide tool,arrows

# sources of a few numbers: isolines of the distance from each
sources_on_plate() { # NAME SOURCE
  plan "source_$1" data/patch_100mm_a.off --source "$2" --pattern contour --spacing 10
  picture "source_$1" "source_$1" --size 480x320 --view top --hide tool,path,arrows --show isolines
}
sources_on_plate geodesic geodesic:20,30,0:80,60,0
sources_on_plate cut cut:0:30
sources_on_plate segment segment:0:0,0.3
sources_on_plate offset offset:50,20

# patches, each in the colour of its turn
plan patches_creases data/patch_100mm_a.off --partition creases --spacing 4
plan patches_medial "${part[@]}" --partition medial --spacing 40
picture patches_creases patches_creases --color patch --hide tool,arrows
picture patches_medial patches_medial --color patch --hide tool,arrows

# circles along the isolines
plan trochoidal data/patch_100mm_a.off --source boundary --pattern trochoidal --spacing 4 --circle-radius 12
picture trochoidal trochoidal --view top --hide tool,arrows

# the medial axis over isolines, seen from above
plate=(data/patch_100mm_a.off --source boundary --quiet)
build/isopath medial-axis "${plate[@]}" --prune 0.5 -o "$out/axis.csv"
build/isopath contours "${plate[@]}" --spacing 8 -o "$out/lines.json"
python3 tools/axis_picture.py "$out/axis.csv" "$out/lines.json" docs/img/medial_axis.svg
echo docs/img/medial_axis.svg

# contours and the medial axis on a part in space
shown() { # NAME COMMAND arguments...
  local name=$1
  shift
  build/isopath "$@" --source boundary --quiet --report "$out/$name.html" >/dev/null
  node tools/screenshot.mjs "$out/$name.html" "docs/img/$name.png" --size 720x480 --only-part
  echo "docs/img/$name.png"
}
shown contours contours data/mech_part_holes.off --unit m --spacing 50
shown medial_axis_on_part medial-axis data/mech_part_holes.off --unit m --prune 2.5

python3 tools/plates.py "$out/plates"

# cusps on waves, in one colour scale: constant scallop and planes
waves=("$out/plates/waves.off" --tool ball:6 --scallop 0.04)
plan scallop_constant "${waves[@]}" --pattern meander --source plane:1,0,0,0
plan scallop_planes "${waves[@]}" --pattern planar --direction 1,0,0
picture scallop_constant scallop_constant --size 480x400 --color scallop --hide tool,path,arrows
picture scallop_planes scallop_planes --size 480x400 --color scallop --hide tool,path,arrows

# blended fields, on parts made for them
blended() { # RUN PART arguments...
  local run=$1 part=$2
  shift 2
  plan "$run" "$out/plates/$part.off" --source boundary --no-report "$@"
}
blended l_distance l --spacing 5 --pattern spiral --blend-form none
blended l_paper l --spacing 5 --pattern spiral --blend-form paper
blended l_least l --spacing 5 --pattern spiral --blend
blended star star --spacing 3 --pattern spiral --blend
blended notch notch --spacing 5 --pattern spiral --blend
blended disc disc --spacing 4 --pattern double-spiral --blend
blended square square --spacing 5 --pattern double-spiral --blend
blended dumbbell dumbbell --spacing 5 --pattern spiral --blend
blended eccentric eccentric --spacing 4 --pattern spiral --blend
blended slab slab --spacing 5 --pattern spiral --blend
blended plate plate --spacing 5 --pattern spiral --blend
python3 tools/path_picture.py docs/img/blend_forms.svg "$out"/l_{distance,paper,least}/impact.csv
python3 tools/path_picture.py docs/img/blend_spirals.svg "$out"/{star,notch}/impact.csv
python3 tools/path_picture.py docs/img/blend_neck.svg "$out"/dumbbell/impact.csv
python3 tools/path_picture.py docs/img/blend_annuli.svg "$out"/{eccentric,slab}/impact.csv
python3 tools/path_picture.py docs/img/blend_holes.svg "$out"/plate/impact.csv
python3 tools/path_picture.py docs/img/double_spirals.svg "$out"/{disc,square}/impact.csv
ls docs/img/blend_*.svg docs/img/double_spirals.svg
