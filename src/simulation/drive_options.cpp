#include "simulation/drive_options.h"

#include "saw_ndt/common/error.h"

namespace saw_ndt {

void DriveOptions::check() const {
  checkOption(drive >= 1, "drive", drive, "1 or greater");
  checkOption(object_density >= 0.0 && object_density <= 1.0, "object_density", object_density, "between 0 and 1");
  checkOption(traffic_density >= 0.0 && traffic_density <= 10.0, "traffic_density", traffic_density,
              "between 0 and 10");
}

}  // namespace saw_ndt
