#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "campaign_run.h"
#include "saw_ndt/common/geometry.h"
#include "saw_ndt/localization/localizer.h"

namespace saw_ndt {

/// Whether the localizer says that it does not know where the vehicle is.
bool isLost(const LocalizationResult& result);

/// How far a pose is off.
struct PoseDifference {
  Vector6d e = Vector6d::Zero();  ///< see poseDifference()
  double distance_m() const { return e.head<3>().norm(); }
  double angle_deg() const { return degreesFromRadians(e.tail<3>().norm()); }
};

/// Whether a pose that is so far off would mislead its user: by more than 0.5 m or 2 degrees, beside what free
/// directions explain: in every axis of the map, three standard deviations of the part of the covariance that is
/// theirs. (A road bends, so that one who is elsewhere on it looks another way.)
bool misleads(const PoseDifference& difference, const Matrix6d& covariance, const PoseDirections& free_directions);

/// e^T C^-1 e, or nothing (a negative number) where the covariance is not positive definite.
double normalizedSquaredError(const PoseDifference& difference, const Matrix6d& covariance);

/// How far squared errors are what covariances say.
struct Consistency {
  double sum = 0.0;           ///< of e^T C^-1 e / 6
  int count = 0, inside = 0;  ///< `inside`: within the ellipsoid of 95 %

  void add(double normalized_squared_error);
  void add(const Consistency& other);
};

/// What a campaign counts over the scans of one or more runs, from the fault on.
struct TrustCounts {
  int runs = 0, failed_runs = 0;  ///< failed: the localizer threw
  int scans = 0, accepted = 0;
  int accepted_of_nothing = 0;            ///< of scans that show nothing
  int rejected_though_right = 0;          ///< the aligned pose within 0.5 m and 2 degrees
  int wrong_accepted = 0;                 ///< see misleads(); in a map of another place, all
  double worst_m = 0.0, worst_deg = 0.0;  ///< of accepted poses
  int astray_before_runs = 0;             ///< the last published pose before the fault was wrong already
  /// Runs in which the published pose was wrong from some scan on, until the localizer said that it is lost or the run
  /// ended.
  int astray_runs = 0;
  std::vector<double> scans_until_lost;  ///< of those where it said so
  int wrongly_lost_runs = 0;             ///< it said so while the published pose was right
  int ended_faults = 0;                  ///< runs with good scans after the fault, in a map of the place
  int recovered_runs = 0;                ///< of those: a right pose was accepted within 5 s
  Consistency of_accepted, of_rejected;

  void add(const TrustCounts& other);
};

/// Counts over one run, scan by scan.
class RunJudge {
 public:
  explicit RunJudge(const CampaignRun& run) : run_(run) { counts_.runs = 1; }

  /// The result for the next scan.
  void see(const LocalizationResult& result);
  /// The localizer threw, which ends the run.
  void fail() { counts_.failed_runs = 1; }

  TrustCounts finish();
  /// The first scan that was accepted wrongly in words: its number, error and standard deviations in the axes of the
  /// base, and what was free; empty for none.
  const std::string& firstWrongAccepted() const { return first_wrong_accepted_; }
  /// The last scan in the same words, and what became of it.
  const std::string& lastInWords() const { return last_in_words_; }

 private:
  const CampaignRun& run_;
  TrustCounts counts_;
  std::size_t next_ = 0;
  int wrong_since_ = -1;
  std::string first_wrong_accepted_, last_in_words_;
  bool was_lost_ = false;
  bool recovered_ = false;
};

/// The head of a Markdown table of TrustCounts, behind columns of the given names.
std::string trustTableHead(const std::vector<std::string>& names);
/// A row of it.
std::string trustTableRow(const std::vector<std::string>& names, const TrustCounts& counts);

}  // namespace saw_ndt
