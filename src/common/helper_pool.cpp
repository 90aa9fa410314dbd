#include "common/helper_pool.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <thread>

namespace saw_ndt::internal {
namespace {

constexpr Assignment kIdle = 0;
constexpr int kNumberBits = 16;
constexpr Assignment kNumberMask = (1U << kNumberBits) - 1;
constexpr int kMostHelpers = (1 << kNumberBits) - 1;

// The loop of which helper to work on, as which worker.
Assignment assignmentOf(std::uint32_t session, std::size_t loop, int worker) {
  return Assignment{session} << (2 * kNumberBits) | Assignment{loop} << kNumberBits | static_cast<Assignment>(worker);
}
SharedLoop& loopOf(Assignment assignment, const Helper& helper) {
  return helper.all[assignment >> kNumberBits & kNumberMask].loop;
}
int workerOf(Assignment assignment) { return static_cast<int>(assignment & kNumberMask); }

// The processors of the main thread: the calling one may have been given one of its own.
cpu_set_t cpusOfProcess() {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  if (sched_getaffinity(getpid(), sizeof(cpus), &cpus) != 0) {  // more than fit into the set
    const std::size_t count = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, CPU_SETSIZE);
    for (std::size_t cpu = 0; cpu < count; ++cpu) CPU_SET(cpu, &cpus);
  }
  return cpus;
}

// The kernel puts a woken thread where its waker runs and may leave it there for 10 ms, behind the waker.
void keepAwayFromCaller(Helper& helper) {
  static const cpu_set_t process_cpus = cpusOfProcess();
  const int cpu = sched_getcpu();
  if (cpu == helper.avoided_cpu || cpu < 0 || cpu >= CPU_SETSIZE) return;
  cpu_set_t cpus = process_cpus;
  CPU_CLR(static_cast<std::size_t>(cpu), &cpus);
  // Fails where no processor is left: the helper stays where it was.
  pthread_setaffinity_np(helper.thread, sizeof(cpus), &cpus);
  helper.avoided_cpu = cpu;
}

// A helper is marked as asleep before it looks for what it is wanted for, see HelperPool::wakeUp().
template <typename Wanted>
void sleepUnless(Wanted wanted, Helper& helper) {
  helper.asleep.store(true, std::memory_order_seq_cst);
  if (wanted() && helper.asleep.exchange(false)) return;
  while (sem_wait(&helper.wake) != 0) {
  }
}

void serve(Assignment assignment, Helper& helper) {
  SharedLoop& loop = loopOf(assignment, helper);
  const int worker = workerOf(assignment);
  const auto dismissed = [&] { return helper.assignment.load(std::memory_order_seq_cst) != assignment; };
  for (int spins = 0; !dismissed(); ++spins) {
    if (loop.help(worker, helper.assignment, assignment)) {
      spins = 0;
    } else if (spins < kSpins) {
      pauseThread();
    } else {
      sleepUnless([&] { return dismissed() || loop.hasChunkFor(worker); }, helper);
      spins = 0;
    }
  }
}

void* runHelper(void* argument) {
  Helper& helper = *static_cast<Helper*>(argument);
  for (;;) {
    const Assignment assignment = helper.assignment.load(std::memory_order_seq_cst);
    if (assignment != kIdle) {
      serve(assignment, helper);
    } else {
      sleepUnless([&] { return helper.assignment.load(std::memory_order_seq_cst) != kIdle; }, helper);
    }
  }
  return nullptr;
}

// A plugin that holds this code may be closed: helpers run it for as long as the process lives.
void keepLoaded() {
  Dl_info info;
  if (dladdr(reinterpret_cast<void*>(&runHelper), &info) != 0 && info.dli_fname != nullptr) {
    dlopen(info.dli_fname, RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
  }
}

}  // namespace

HelperPool& HelperPool::ofProcess() {
  static HelperPool& pool = *[] {
    const cpu_set_t cpus = cpusOfProcess();
    return new HelperPool(CPU_COUNT(&cpus) - 1);
  }();
  return pool;
}

HelperPool::HelperPool(int helper_count)
    : helper_count_(std::min(helper_count, kMostHelpers)),
      helpers_(new Helper[static_cast<std::size_t>(helper_count_)]),
      process_(getpid()) {
  for (int i = 0; i < helper_count_; ++i) helpers_[i].all = helpers_.get();
  keepLoaded();
}

Helper* HelperPool::borrow(int most) {
  if (most <= 0 || isForked()) return nullptr;
  const std::uint32_t session = session_count_.fetch_add(1, std::memory_order_relaxed);
  Helper* first = nullptr;
  Helper** link = &first;
  std::size_t loop = 0;
  int worker = 1;
  for (std::size_t i = 0; i < static_cast<std::size_t>(helper_count_) && worker <= most; ++i) {
    Helper& helper = helpers_[i];
    if (helper.assignment.load(std::memory_order_relaxed) != kIdle) continue;
    if (first == nullptr) loop = i;
    Assignment idle = kIdle;
    if (!helper.assignment.compare_exchange_strong(idle, assignmentOf(session, loop, worker))) continue;
    if (helper.started) {
      wakeUp(helper);
    } else if (!start(helper)) {
      helper.assignment.store(kIdle, std::memory_order_release);
      break;
    }
    helper.next = nullptr;
    *link = &helper;
    link = &helper.next;
    ++worker;
  }
  return first;
}

void HelperPool::run(Helper& first, std::size_t chunk_count, int workers, const ChunkBody& body) const {
  first.loop.open(chunk_count, workers, body);
  std::size_t wanted = std::min(chunk_count, static_cast<std::size_t>(workers)) - 1;
  for (Helper* helper = &first; helper != nullptr && wanted > 0; helper = helper->next, --wanted) wakeUp(*helper);
  first.loop.complete();
}

void HelperPool::giveBack(Helper* first) {
  // The first one last: who takes it gets the loop, which no other helper of this session may serve by then.
  for (Helper* helper = first->next; helper != nullptr;) {
    Helper* const next = helper->next;
    helper->assignment.store(kIdle, std::memory_order_release);
    helper = next;
  }
  first->assignment.store(kIdle, std::memory_order_release);
}

// What the helper is wanted for has been written down before.
void HelperPool::wakeUp(Helper& helper) const {
  if (!helper.asleep.load(std::memory_order_seq_cst) || !helper.asleep.exchange(false) || isForked()) return;
  keepAwayFromCaller(helper);
  sem_post(&helper.wake);
}

bool HelperPool::isForked() const { return getpid() != process_; }

bool HelperPool::start(Helper& helper) {
  // The program's signals are not for helpers.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  helper.started = pthread_create(&helper.thread, nullptr, runHelper, &helper) == 0;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (!helper.started) return false;
  pthread_detach(helper.thread);
  pthread_setname_np(helper.thread, "saw_ndt_helper");
  keepAwayFromCaller(helper);
  return true;
}

}  // namespace saw_ndt::internal
