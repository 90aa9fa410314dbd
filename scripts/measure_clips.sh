#!/usr/bin/env bash
# Prints the README's tables of localization and segmentation on short KITTI clips, as Markdown.
# usage: scripts/measure_clips.sh KITTI_FOLDER [THREADS]
# KITTI_FOLDER holds sequences/<name> and poses/<name>.txt; the clips are 00, 01, 03 and drive_0005.
set -euo pipefail

kitti=${1:?usage: scripts/measure_clips.sh KITTI_FOLDER [THREADS]}
threads=${2:-$(nproc)}
apps=$(cd "$(dirname "$0")/.." && pwd)/build/release/apps
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# field NAME FILE: the number after "NAME" in a JSON file; inside an object, OBJECT.NAME.
field() {
  local name=${1##*.} object=${1%.*}
  if [ "$object" != "$1" ]; then
    sed -n "/\"$object\": {/,/}/p" "$2" | sed -n "s/.*\"$name\": \([-0-9.e+]*\).*/\1/p" | head -n 1
  else
    sed -n "s/^  \"$name\": \([-0-9.e+]*\).*/\1/p" "$2" | head -n 1
  fi
}

echo "Localization, $threads threads:"
echo
echo "| clip, scans | method | accepted | ATE m | P95 / max m | yaw MAE / P95 deg | evaluations | source points | segment / filter / align ms | total ms mean / P95 |"
echo "|---|---|---|---|---|---|---|---|---|---|"
for run in "drive_0005 0:70:2 1:70:2" "drive_0005 0:70:2 1:70:6" "drive_0005 0:70:2 1:70:10" "00 0:10:2 1:10:2" \
           "01 0:10:2 1:10:2" "03 0:10:2 1:10:2"; do
  read -r clip map_scans scans <<<"$run"
  map=$work/$clip.map
  [ -f "$map" ] || "$apps/saw_ndt_build_map" "$kitti/sequences/$clip" "$map" -scans "$map_scans" -threads "$threads" >/dev/null
  for method in weighted weighted-s50 weighted-s100 unweighted-s50 classical; do
    json=$work/summary.json
    "$apps/saw_ndt_localize" "$kitti/sequences/$clip" "$map" "$work/out" -scans "$scans" -skip 0 -method "$method" \
      -threads "$threads" >"$json"
    printf '| %s, %s | %s | %d / %d | %.4f | %.4f / %.4f | %.4f / %.4f | %.1f | %.0f | %.1f / %.1f / %.1f | %.1f / %.1f |\n' \
      "$clip" "$scans" "$method" "$(field accepted "$json")" "$(field scans "$json")" "$(field ate_rmse_m "$json")" \
      "$(field position_p95_m "$json")" "$(field position_max_m "$json")" "$(field yaw_mae_deg "$json")" \
      "$(field yaw_p95_deg "$json")" "$(field evaluations_mean "$json")" "$(field source_points_mean "$json")" \
      "$(field segment_ms.mean "$json")" "$(field filter_ms.mean "$json")" "$(field align_ms.mean "$json")" \
      "$(field total_ms.mean "$json")" "$(field total_ms.p95 "$json")"
    [ "${scans##*:}" != 2 ] || echo "$method $(field ate_rmse_m "$json")" >>"$work/ate"
  done
done

echo
echo "Mean ATE over the four runs of every second scan:"
echo
awk '{ if (!($1 in sum)) order[++n] = $1; sum[$1] += $2; count[$1]++ }
  END { for (i = 1; i <= n; i++) printf "- %s: %.2f mm\n", order[i], 1000 * sum[order[i]] / count[order[i]] }' "$work/ate"

echo
echo "Ground segmentation against SemanticKITTI, means over the scans of each sequence:"
echo
echo "| sequence | rule | precision | recall | F1 | IoU | noise share |"
echo "|---|---|---|---|---|---|---|"
for clip in 00 01 03; do
  for rule in growing inclination; do
    : >"$work/scores"
    for scan in "$kitti/sequences/$clip/velodyne"/*.bin; do
      labels=$kitti/sequences/$clip/labels/$(basename "$scan" .bin).label
      "$apps/saw_ndt_segment" "$scan" "$work/labelled.pcd" -labels "$labels" -ground-rule "$rule" >"$work/score.json"
      echo "$(field precision "$work/score.json") $(field recall "$work/score.json") $(field f1 "$work/score.json")" \
        "$(field iou "$work/score.json") $(field noise_share "$work/score.json")" >>"$work/scores"
    done
    awk -v clip="$clip" -v rule="$rule" '{ for (i = 1; i <= 5; i++) sum[i] += $i }
      END { printf "| %s | %s |", clip, rule; for (i = 1; i <= 5; i++) printf " %.4f |", sum[i] / NR; print "" }' \
      "$work/scores"
  done
done
