// Example 1: compute with your own structs. Every element sums 0 + 1 + ... + (n - 1), on the host and on every device;
// the table shows what that costs for several numbers of elements and work-group sizes.
//   example_01_compute [ELEMENTS]
// Or every struct meets every other one, n^2 work: a table over structs and items in flight, each of which takes a part
// of the structs, beside one thread of the host. It shows from how many items on a device is busy.
//   example_01_compute pairs [STRUCTS]
#include <algorithm>
#include <chrono>
#include <claray/program.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

// Any plain struct works, as long as the kernel declares the same one.
struct Element {
    std::uint32_t n;
    std::uint32_t spare;
    std::uint64_t sum;
};

// `mask` is 0 and changes nothing, but a compiler that knew it would replace the loop by n (n - 1) / 2.
const char* source = R"(
    typedef struct { uint n; uint spare; ulong sum; } Element;

    kernel void sum_up(global Element* elements, uint count, uint mask) {
        const uint e = get_global_id(0);
        if (e >= count) return;  // the last work-group may be larger than what is left
        ulong sum = 0;
        for (uint i = 0; i < elements[e].n; ++i) sum += i ^ mask;
        elements[e].sum = sum;
    }

    // Any number of items: each takes every get_global_size(0)-th element.
    kernel void sum_pairs(global Element* elements, uint count) {
        for (uint e = get_global_id(0); e < count; e += get_global_size(0)) {
            const uint n = elements[e].n;
            ulong sum = 0;
            for (uint i = 0; i < count; ++i) sum += n ^ elements[i].n;
            elements[e].sum = sum;
        }
    })";

std::vector<Element> make_elements(std::size_t count) {
    std::vector<Element> elements(count);
    for (std::size_t e = 0; e < count; ++e) elements[e].n = std::uint32_t(500 + e % 500);
    return elements;
}

bool correct(const std::vector<Element>& elements) {
    for (const Element& e : elements)
        if (e.sum != std::uint64_t(e.n) * (e.n - 1) / 2) return false;
    return true;
}

void print_row(const char* name, std::size_t count, std::size_t group, double milliseconds, bool is_correct) {
    std::printf("%-40.40s %9zu %6zu %10.3f ms  %s\n", name, count, group, milliseconds,
                is_correct ? "correct" : "WRONG");
    if (!is_correct) std::exit(1);
}

void sum_on_host(std::size_t count) {
    std::vector<Element> elements = make_elements(count);
    const volatile std::uint32_t mask = 0;
    const std::uint32_t opaque_mask = mask;
    const auto begin = std::chrono::steady_clock::now();
    for (Element& e : elements)
        for (std::uint32_t i = 0; i < e.n; ++i) e.sum += i ^ opaque_mask;
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    print_row("host, one thread", count, 1, time.count(), correct(elements));
}

void sum_on_device(const claray::Device& device, std::size_t count, std::size_t group) {
    const std::vector<Element> elements = make_elements(count);

    // The whole framework in four lines: upload, compile, run, download.
    claray::Buffer<Element> buffer(device, elements);
    claray::Kernel sum_up = claray::compile_kernel(device, source, "sum_up");
    sum_up.run({count, group}, buffer, std::uint32_t(count), 0u);
    const std::vector<Element> sums = buffer.read();

    device.profiler().reset();  // the first run included the driver's last steps of compiling: measure another
    sum_up.run({count, group}, buffer, std::uint32_t(count), 0u);
    print_row(device.info().name.c_str(), count, group, device.profiler().milliseconds("sum_up"), correct(sums));
}

double pairs_on_host(std::vector<Element>& elements) {
    const auto begin = std::chrono::steady_clock::now();
    for (Element& e : elements)
        for (const Element& other : elements) e.sum += e.n ^ other.n;
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

// All elements once, by `items` items in flight.
double pairs_on_device(const claray::Device& device, claray::Kernel& sum_pairs, const std::vector<Element>& expected,
                       std::size_t items) {
    claray::Buffer<Element> buffer(device, make_elements(expected.size()));
    sum_pairs.run({items, std::min<std::size_t>(items, 64)}, buffer, std::uint32_t(expected.size()));
    const std::vector<Element> sums = buffer.read();
    for (std::size_t e = 0; e < sums.size(); ++e)
        if (sums[e].sum != expected[e].sum) throw claray::Error(claray::ErrorKind::device, "a sum of pairs is wrong");
    device.profiler().reset();
    sum_pairs.run({items, std::min<std::size_t>(items, 64)}, buffer, std::uint32_t(expected.size()));
    device.finish();
    return device.profiler().milliseconds("sum_pairs");
}

void print_pairs(std::size_t most) {
    const std::size_t all_items[] = {1, 4, 16, 64, 256, 1024, 4096, 16384};
    std::vector<std::vector<Element>> sums;
    std::printf("milliseconds for n^2 pairs of structs\n%-32s %8s", "", "structs:");
    for (const std::size_t count : {most / 16, most / 4, most})
        sums.push_back(make_elements(std::max<std::size_t>(count, 1)));
    for (const auto& elements : sums) std::printf(" %11zu", elements.size());
    std::printf("\n%-32s %8d", "host, one thread", 1);
    for (auto& elements : sums) std::printf(" %11.3f", pairs_on_host(elements));
    for (const claray::DeviceInfo& info : claray::list_devices()) {
        const claray::Device device = claray::Device::open(std::to_string(info.index));
        claray::Kernel sum_pairs = claray::compile_kernel(device, source, "sum_pairs");
        for (const std::size_t items : all_items) {
            std::printf("\n%-32.32s %8zu", info.name.c_str(), items);
            for (const auto& elements : sums)
                std::printf(" %11.3f", pairs_on_device(device, sum_pairs, elements, items));
            std::fflush(stdout);
        }
    }
    std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc > 1 && std::strcmp(argv[1], "pairs") == 0) {
        print_pairs(std::size_t(argc > 2 ? std::clamp(std::atoll(argv[2]), 1LL, 1LL << 20) : 8192));
        return 0;
    }
    const auto most = std::size_t(argc > 1 ? std::max(0LL, std::atoll(argv[1])) : 1'000'000);
    std::printf("%-40s %9s %6s %13s\n", "device", "elements", "group", "time");
    for (const std::size_t count : {most / 100, most / 10, most}) {
        sum_on_host(count);
        for (const claray::DeviceInfo& info : claray::list_devices()) {
            const claray::Device device = claray::Device::open(std::to_string(info.index));
            for (const std::size_t group : {16, 64, 256})
                if (group <= info.max_work_group) sum_on_device(device, count, group);
        }
    }
    return 0;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
