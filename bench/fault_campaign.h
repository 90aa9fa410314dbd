#pragma once

#include <functional>
#include <string>
#include <vector>

#include "campaign_run.h"
#include "simulation/random_numbers.h"

namespace saw_ndt {

/// Scans before a fault that comes on the way, at least and at most.
constexpr std::size_t kLeastRunUp = 30, kGreatestRunUp = 230;

/// Which map a run is localized in.
enum class CampaignMap {
  OWN,             ///< of the scene
  CHANGED,         ///< of the scene when a third of its objects was missing
  OF_OTHER_SCENE,  ///< of another place altogether
};

/// Something that goes wrong in a drive.
struct Fault {
  std::string kind;      ///< one word, such as `kidnapping`
  std::string strength;  ///< how bad it is, such as "5 m"; empty where there is one kind only
  /// The fault is there from the first scan on, and runs start anywhere on the way; otherwise they start where the
  /// drive does, so that what is known of the motion comes from where there is something to see.
  bool from_start = false;
  CampaignDrive drive = CampaignDrive::TEST;
  CampaignMap map = CampaignMap::OWN;
  /// Changes a run as recorded into one with the fault, from CampaignRun::fault_begin on; what is random is drawn anew
  /// for every run. Empty: the fault is in drive or map.
  std::function<void(CampaignRun& run, const LoadedDrive& drive, SceneRandom& random)> apply;
};

/// Every fault, those of one kind one after the other.
const std::vector<Fault>& allFaults();
/// Their kinds.
std::vector<std::string> faultKinds();

}  // namespace saw_ndt
