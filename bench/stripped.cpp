// What the kernels' knowledge of unused effects costs: the diffuse Cornell box by the kernels that claray specialises
// for it, against kernels from which all other effects were removed by hand (bench/stripped), by turns:
//   bench_stripped [--restarts N] [--rounds N] [--csv FILE]
// Two processes, for kernels are read once; they are started anew several times, since where memory lies matters, too.
// CPUs only. Both must make the same image bit for bit.
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string csv, kernels = CLARAY_STRIPPED_KERNELS;
    int restarts = 8, rounds = 12;
    unsigned size = 256, batches = 8;
};

struct Message {
    double seconds = 0;       // of the processors, a million samples
    std::uint64_t image = 0;  // a hash of its bits
};

std::uint64_t hash_of(const std::vector<glm::vec3>& image) {
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a
    for (const glm::vec3& pixel : image)
        for (int i = 0; i < 3; ++i) {
            std::uint32_t word;
            std::memcpy(&word, &pixel[i], sizeof word);
            hash = (hash ^ word) * 1099511628211u;
        }
    return hash;
}

/// Renders some batches whenever it is told to, until there is nobody to tell it.
void serve(const Options& options, int orders, int replies) {
    const Device device = Device::open("cpu");
    const Scene scene = *builtin_scene("cornell");
    Renderer small(device, scene, {.width = 61, .height = 47, .spp = 9});
    (void)small.render();
    Renderer renderer(device, scene, {.width = options.size, .height = options.size, .spp = 1u << 20});
    Message message;
    message.image = hash_of(small.image());
    char order = 0;
    while (read(orders, &order, 1) == 1) {
        const std::uint64_t samples = renderer.statistics().camera.rays;
        const std::clock_t begin = std::clock();
        for (unsigned i = 0; i < options.batches; ++i)
            (void)renderer.render([](const RenderProgress&) { return false; });
        const double seconds = double(std::clock() - begin) / CLOCKS_PER_SEC;
        message.seconds = seconds * 1e6 / double(renderer.statistics().camera.rays - samples);
        if (write(replies, &message, sizeof message) != sizeof message) return;
    }
}

/// A process of its own.
class Server {
public:
    Server(const Options& options, const char* kernels) {
        int orders[2], replies[2];
        if (pipe(orders) != 0 || pipe(replies) != 0) throw Error(ErrorKind::user, "cannot open pipes");
        process_ = fork();
        if (process_ < 0) throw Error(ErrorKind::user, "cannot start a process");
        if (process_ == 0) {
            close(orders[1]), close(replies[0]);
            if (kernels)
                setenv("CLARAY_KERNEL_DIR", kernels, 1);
            else
                unsetenv("CLARAY_KERNEL_DIR");
            _exit(run(options, orders[0], replies[1]));
        }
        close(orders[0]), close(replies[1]);
        orders_ = orders[1], replies_ = replies[0];
    }
    ~Server() {
        close(orders_), close(replies_);
        waitpid(process_, nullptr, 0);
    }
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] Message render() const {
        Message message;
        if (write(orders_, "r", 1) != 1 || read(replies_, &message, sizeof message) != sizeof message)
            throw Error(ErrorKind::device, "a process that renders has ended");
        return message;
    }

private:
    static int run(const Options& options, int orders, int replies) try {
        serve(options, orders, replies);
        return 0;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return int(error.kind());
    }

    pid_t process_;
    int orders_ = -1, replies_ = -1;
};

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("The kernels specialised for the Cornell box against kernels stripped by hand");
    Options options;
    app.add_option("--restarts", options.restarts, "pairs of processes [8]");
    app.add_option("--rounds", options.rounds, "measured by each [12]");
    app.add_option("--size", options.size, "pixels a side [256]");
    app.add_option("--batches", options.batches, "rendered a round [8]");
    app.add_option("--kernels", options.kernels, "the stripped kernels");
    app.add_option("--csv", options.csv);
    CLI11_PARSE(app, argc, argv);
    std::vector<double> ratios, own_times, stripped_times;
    bool same = true;
    for (int restart = 0; restart < options.restarts; ++restart) {
        const Server own(options, nullptr), stripped(options, options.kernels.c_str());
        (void)own.render(), (void)stripped.render();
        for (int round = 0; round < options.rounds; ++round) {
            const bool own_first = (round + restart) % 2 == 0;
            const Message first = (own_first ? own : stripped).render();
            const Message second = (own_first ? stripped : own).render();
            const Message& a = own_first ? first : second;
            const Message& b = own_first ? second : first;
            own_times.push_back(a.seconds), stripped_times.push_back(b.seconds);
            ratios.push_back(a.seconds / b.seconds);
            same &= a.image == b.image;
        }
    }
    const double ratio = measure::median(ratios), spread = measure::relative_spread(ratios);
    const double least = *std::min_element(own_times.begin(), own_times.end()) /
                         *std::min_element(stripped_times.begin(), stripped_times.end());
    std::printf(
        "processor time, specialised over stripped by hand: %.4f (median of %zu pairs, quartiles +-%.4f), of the "
        "least times %.4f; images %s\n",
        ratio, ratios.size(), ratio * spread, least, same ? "the same bit for bit" : "DIFFER");
    if (!options.csv.empty()) {
        char row[256];
        std::snprintf(row, sizeof row,
                      "scene,pairs,median_ratio,quartiles,ratio_of_least\ncornell,%zu,%.5f,%.5f,%.5f\n", ratios.size(),
                      ratio, ratio * spread, least);
        write_file(options.csv, row);
    }
    return same ? 0 : 1;
} catch (const Error& error) {
    std::fprintf(stderr, "bench_stripped: %s\n", error.what());
    return int(error.kind());
}
