#include "drives/velodyne_socket.h"

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/multicast.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "io/velodyne_stream.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using Clock = std::chrono::steady_clock;

constexpr int kReceiveBufferBytes = 4 << 20;
constexpr std::chrono::seconds kLongestSilence(1);
constexpr std::chrono::milliseconds kPauseAfterError(10);

double systemTime_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

udp::socket listeningSocket(asio::io_context& context, const std::string& address, std::uint16_t port) {
  const std::string name = "udp:" + address + ":" + std::to_string(port);
  try {
    const asio::ip::address parsed = asio::ip::make_address(address);
    const udp protocol = parsed.is_v6() ? udp::v6() : udp::v4();
    udp::socket socket(context, protocol);
    // The system grants less where its limit is lower.
    socket.set_option(udp::socket::receive_buffer_size(kReceiveBufferBytes));
    if (parsed.is_multicast()) {
      socket.set_option(udp::socket::reuse_address(true));
      socket.bind(udp::endpoint(protocol, port));
      socket.set_option(asio::ip::multicast::join_group(parsed));
    } else {
      socket.bind(udp::endpoint(parsed, port));
    }
    return socket;
  } catch (const boost::system::system_error& error) {
    throw Error(name, "", error.code().message());
  }
}

class VelodyneSocket : public LiveSource {
 public:
  VelodyneSocket(const std::string& address, std::uint16_t port, const std::filesystem::path& calibration,
                 std::size_t max_waiting)
      : stream_(calibration),
        socket_(listeningSocket(context_, address, port)),
        pause_(context_),
        max_waiting_(max_waiting) {
    receive();
    thread_ = std::thread([this] { run(); });
  }

  ~VelodyneSocket() override {
    stop();
    thread_.join();
  }

  VelodyneSocket(const VelodyneSocket&) = delete;
  VelodyneSocket& operator=(const VelodyneSocket&) = delete;

  bool next(RecordedScan& scan) override {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return is_stopped_ || failure_ || !waiting_.empty(); });
    if (is_stopped_) return false;
    if (failure_) std::rethrow_exception(failure_);
    std::swap(static_cast<ScanPoints&>(scan), waiting_.front().points);
    scan.stamp_s = waiting_.front().stamp_s;
    scan.number = next_number_ - static_cast<int>(waiting_.size());
    waiting_.pop_front();
    lock.unlock();
    scan.name = "scan " + std::to_string(scan.number);
    scan.T_map_lidar.reset();
    scan.priors = ScanPriors();
    scan.failure.clear();
    return true;
  }

  void stop() override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_stopped_ = true;
    }
    changed_.notify_all();
    context_.stop();
  }

  std::size_t leftOut() const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return left_out_;
  }

  std::size_t rejected() const override { return rejected_.load(std::memory_order_relaxed); }

 private:
  void run() {
    try {
      context_.run();
    } catch (...) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        failure_ = std::current_exception();
      }
      changed_.notify_all();
    }
  }

  void receive() {
    socket_.async_receive_from(asio::buffer(packet_), sender_,
                               [this](const boost::system::error_code& error, std::size_t size) {
                                 if (!error) {
                                   if (!take(size)) rejected_.fetch_add(1, std::memory_order_relaxed);
                                   receive();
                                   return;
                                 }
                                 // Such as a network that is down for a while.
                                 pause_.expires_after(kPauseAfterError);
                                 pause_.async_wait([this](const boost::system::error_code&) { receive(); });
                               });
  }

  bool take(std::size_t size) {
    const Clock::time_point now = Clock::now();
    if (sensor_ && sender_ != *sensor_) {
      if (now - last_taken_ < kLongestSilence) return false;
      sensor_.reset();
      stream_.restart();
    }
    if (!stream_.add(packet_.data(), size, systemTime_s(), [this](StreamedScan& scan) { hand(scan); })) return false;
    sensor_ = sender_;
    last_taken_ = now;
    return true;
  }

  void hand(StreamedScan& scan) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      waiting_.push_back(std::move(scan));
      ++next_number_;
      if (waiting_.size() > max_waiting_) {
        left_out_ += waiting_.size() - 1;
        waiting_.erase(waiting_.begin(), waiting_.end() - 1);
      }
    }
    changed_.notify_all();
  }

  // Of the thread that receives.
  VelodyneStream stream_;
  asio::io_context context_{1};
  udp::socket socket_;
  asio::steady_timer pause_;
  // One byte more than a data packet, so that longer ones are told.
  std::array<std::uint8_t, kVelodynePacketBytes + 1> packet_{};
  udp::endpoint sender_;
  std::optional<udp::endpoint> sensor_;
  Clock::time_point last_taken_;

  std::atomic<std::size_t> rejected_{0};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // By the mutex.
  bool is_stopped_ = false;
  std::exception_ptr failure_;
  std::size_t max_waiting_;
  std::deque<StreamedScan> waiting_;
  int next_number_ = 0;  // of the scan that comes next: those that wait have the ones before
  std::size_t left_out_ = 0;

  std::thread thread_;
};

}  // namespace

std::unique_ptr<LiveSource> listenToVelodyne(const std::string& address, std::uint16_t port,
                                             const std::filesystem::path& calibration, std::size_t max_waiting) {
  return std::make_unique<VelodyneSocket>(address, port, calibration, max_waiting);
}

}  // namespace saw_ndt::internal
