#include "host/compute/programs/compiler_processes.hpp"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <iostream>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "host/base/in_parallel.hpp"
#include "host/base/process/process.hpp"
#include "host/compute/programs/compile_program.hpp"

namespace claray {
namespace {

std::string compiler_program;

/// Each process opens a context, which takes about half a gigabyte of a GPU's memory.
unsigned most_processes(const Device& device) {
    constexpr unsigned bytes_per_process_log2 = 30;
    const auto fit = unsigned(std::min<std::uint64_t>(device.info().memory >> bytes_per_process_log2, 1024));
    return std::min({device.tuning("compute/programs", "PROCESSES"), fit, std::thread::hardware_concurrency()});
}

/// The processes for all threads.
class Compilers {
public:
    /// Waits for one of `most` processes of the device, and for its answer.
    void compile(const std::string& device, unsigned most, const ProgramRequest& program) {
        const std::string line = to_text(program), key = device + ' ' + line;
        std::unique_lock lock(mutex_);
        if (keys_.contains(key)) {
            changed_.wait(lock, [&] { return !keys_.contains(key); });
            return;
        }
        keys_.insert(key);
        changed_.wait(lock, [&] { return busy_ < most; });
        ++busy_;
        std::unique_ptr<AnsweringProcess> process = take(device);
        lock.unlock();
        if (!process)
            process = std::make_unique<AnsweringProcess>(
                std::vector<std::string>{compiler_program, "compile", "--serve", "--device", device});
        static_cast<void>(process->ask(line));
        lock.lock();
        --busy_;
        keys_.erase(key);
        if (!process->has_ended()) idle_.push_back({device, std::move(process)});
        changed_.notify_all();
    }
    void keep() {
        const std::lock_guard lock(mutex_);
        ++keepers_;
    }
    void release() {
        const std::lock_guard lock(mutex_);
        if (--keepers_ > 0 || idle_.empty()) return;
        std::thread([ended = std::exchange(idle_, {})] {}).detach();  // each takes a tenth of a second to end
    }

private:
    struct Idle {
        std::string device;
        std::unique_ptr<AnsweringProcess> process;
    };

    /// An idle process of the device, or null.
    std::unique_ptr<AnsweringProcess> take(const std::string& device) {
        const auto found = std::find_if(idle_.begin(), idle_.end(), [&](const Idle& i) { return i.device == device; });
        if (found == idle_.end()) return nullptr;
        std::unique_ptr<AnsweringProcess> process = std::move(found->process);
        idle_.erase(found);
        return process;
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::set<std::string> keys_;  // of what is compiled now
    std::vector<Idle> idle_;
    unsigned busy_ = 0, keepers_ = 0;
};

Compilers compilers;

}  // namespace

void set_compiler_program(const std::string& path) { compiler_program = path; }

bool has_compiler_processes(const Device& device) {
    return !compiler_program.empty() && !has_own_kernel_sources() && most_processes(device) > 1;
}

void compile_in_processes(const Device& device, const std::vector<ProgramRequest>& programs,
                          const std::function<void()>& one_done) {
    const KeepCompilers keep;
    const std::string number = std::to_string(device.info().index);
    in_parallel(programs.size(), [&](std::size_t i) {
        compilers.compile(number, most_processes(device), programs[i]);
        if (one_done) one_done();
    });
}

KeepCompilers::KeepCompilers() { compilers.keep(); }
KeepCompilers::~KeepCompilers() { compilers.release(); }

namespace {

/// Ends this process, in the middle of a compilation, when the one that asks has ended: nobody will read the answer.
void end_with_asking_process() {
    std::thread([] {
        struct pollfd asking = {STDIN_FILENO, POLLRDHUP, 0};
        while (::poll(&asking, 1, -1) < 0 && errno == EINTR) {
        }
        ::_exit(0);
    }).detach();
}

}  // namespace

void serve_as_compiler(const Device& device) {
    struct stat input = {};
    if (::fstat(STDIN_FILENO, &input) == 0 && S_ISSOCK(input.st_mode)) end_with_asking_process();
    for (std::string line; std::getline(std::cin, line);) {
        const ProgramRequest program = parse_program(line);
        try {
            (void)compile_program(device, kernel_source(program.file), build_options(device, program.defines));
            std::cout << "done" << std::endl;
        } catch (const Error&) {
            std::cout << "failed" << std::endl;
        }
    }
}

}  // namespace claray
