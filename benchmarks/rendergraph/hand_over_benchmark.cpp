// The price of a second thread: handing an empty job to a thread that waits, and waiting until it has come back. The
// two are kept on different processors, since only there they could work at the same time; left alone the scheduler
// puts them on one, where a hand-over is cheap and gains nothing. Real time; the median of all is a counter, since one
// that meets a busy processor takes long.
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

namespace {

/// Those that the process may use.
cpu_set_t allowed_processors() {
    cpu_set_t allowed = {};
    pthread_getaffinity_np(pthread_self(), sizeof allowed, &allowed);
    return allowed;
}

/// Keeps a thread on one processor, the `index`-th of those allowed; false where that could not be done.
bool keep_on(pthread_t thread, const cpu_set_t& allowed, int index) {
    for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
        if (CPU_ISSET(processor, &allowed) && index-- == 0) {
            cpu_set_t one = {};
            CPU_SET(processor, &one);
            return pthread_setaffinity_np(thread, sizeof one, &one) == 0;
        }
    }
    return false;
}

/// Keeps the calling thread on the first processor and another on the second, and lets the first go again.
class TwoProcessors {
public:
    explicit TwoProcessors(std::thread& other)
        : allowed_(allowed_processors()),
          apart_(keep_on(pthread_self(), allowed_, 0) && keep_on(other.native_handle(), allowed_, 1)) {}
    TwoProcessors(const TwoProcessors&) = delete;
    TwoProcessors& operator=(const TwoProcessors&) = delete;
    ~TwoProcessors() { pthread_setaffinity_np(pthread_self(), sizeof allowed_, &allowed_); }
    [[nodiscard]] bool are_apart() const { return apart_; }

private:
    cpu_set_t allowed_;
    bool apart_;
};

enum class Job : int { none, given, end };

/// Both sides sleep on a condition variable.
class ConditionWorker {
public:
    ConditionWorker() : thread_([this] { work(); }) {}
    ConditionWorker(const ConditionWorker&) = delete;
    ConditionWorker& operator=(const ConditionWorker&) = delete;
    ~ConditionWorker() {
        set(Job::end);
        thread_.join();
    }

    [[nodiscard]] std::thread& thread() { return thread_; }
    void hand_over() {
        set(Job::given);
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return job_ == Job::none; });
    }

private:
    void set(Job job) {
        {
            const std::scoped_lock lock(mutex_);
            job_ = job;
        }
        changed_.notify_one(); // one side at most is waiting
    }
    void work() {
        while (true) {
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [this] { return job_ != Job::none; });
                if (job_ == Job::end) {
                    return;
                }
            }
            set(Job::none);
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    Job job_ = Job::none;
    std::thread thread_; ///< last: it uses the others
};

/// Both sides wait on an atomic, which looks a few times before it sleeps.
class AtomicWorker {
public:
    AtomicWorker() : thread_([this] { work(); }) {}
    AtomicWorker(const AtomicWorker&) = delete;
    AtomicWorker& operator=(const AtomicWorker&) = delete;
    ~AtomicWorker() {
        set(Job::end);
        thread_.join();
    }

    [[nodiscard]] std::thread& thread() { return thread_; }
    void hand_over() {
        set(Job::given);
        job_.wait(Job::given);
    }

private:
    void set(Job job) {
        job_ = job;
        job_.notify_one(); // one side at most is waiting
    }
    void work() {
        while (true) {
            job_.wait(Job::none);
            if (job_ == Job::end) {
                return;
            }
            set(Job::none);
        }
    }

    std::atomic<Job> job_ = Job::none;
    std::thread thread_; ///< last: it uses the other
};

/// Its argument is the pause between two jobs in microseconds: 0, or that of a thread that works once a frame.
template <typename Worker>
void hand_over(benchmark::State& state) {
    using Clock = std::chrono::steady_clock;
    const std::chrono::microseconds pause(state.range(0));
    Worker worker;
    const TwoProcessors processors(worker.thread());
    if (!processors.are_apart()) {
        state.SkipWithError("needs two processors");
        return;
    }
    std::vector<double> times_us;
    for (auto _ : state) {
        if (pause.count() > 0) {
            std::this_thread::sleep_for(pause);
        }
        const Clock::time_point start = Clock::now();
        worker.hand_over();
        const std::chrono::duration<double> taken = Clock::now() - start;
        state.SetIterationTime(taken.count());
        times_us.push_back(taken.count() * 1e6);
    }
    const auto middle = times_us.begin() + static_cast<std::ptrdiff_t>(times_us.size() / 2);
    std::nth_element(times_us.begin(), middle, times_us.end());
    state.counters["median_us"] = *middle;
}
BENCHMARK_TEMPLATE(hand_over, ConditionWorker)
    ->Arg(0)
    ->Arg(2'000)
    ->Iterations(2'000)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(hand_over, AtomicWorker)
    ->Arg(0)
    ->Arg(2'000)
    ->Iterations(2'000)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

} // namespace
