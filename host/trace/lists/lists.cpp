#include "host/trace/lists/lists.hpp"
#include "host/bvh/bvh_state.hpp"

namespace claray {
namespace {

/// The sums of all counts before each, and of all. Blocks.
std::vector<std::uint32_t> sums_of(const Buffer<std::uint32_t>& counts, std::uint32_t queries) {
    std::vector<std::uint32_t> numbers(queries), offsets(std::size_t(queries) + 1);
    counts.read(std::span(numbers));
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < queries; ++i) {
        sum += numbers[i];
        if (sum > 4'000'000'000)
            throw Error(ErrorKind::usage,
                        "the first " + std::to_string(i + 1) + " of " + std::to_string(queries) +
                            " queries have more than 4e9 results",
                        "ask fewer queries at a time");
        offsets[i + 1] = std::uint32_t(sum);
    }
    return offsets;
}

template <class T>
constexpr const char* suffix = sizeof(T) == sizeof(std::uint32_t) ? "ids" : "hits";

}  // namespace

template <class T>
CountedLists<T> make_lists(const Bvh& bvh, std::uint32_t queries, const FindLists<T>& find) {
    const Device& device = bvh.device();
    Buffer<std::uint32_t> counts(device, queries);
    if (queries == 0) return {{{device, std::vector<std::uint32_t>{0}}, {device, 0}}, counts};
    find({}, {}, counts);
    const auto upload = [&] {
        const std::vector<std::uint32_t> offsets = sums_of(counts, queries);
        return Lists<T>{{device, offsets}, {device, offsets.back()}};
    };
    Lists<T> lists = upload();
    find(lists.offsets, lists.elements, counts);
    const std::string kinds = suffix<T>;
    load_kernel(device, "trace/lists/lists.cl", "sort_" + kinds)
        .run({queries, 64}, arg("elements", lists.elements), arg("offsets", lists.offsets), queries,
             arg("counts", counts));
    if (!state_of(bvh).splits()) return {lists, counts};
    const Lists<T> packed = upload();
    load_kernel(device, "trace/lists/lists.cl", "pack_" + kinds)
        .run({queries, 64}, arg("from", lists.elements), arg("from_offsets", lists.offsets), queries,
             arg("offsets", packed.offsets), arg("to", packed.elements));
    return {packed, counts};
}

template <class T>
void count_results(const Bvh& bvh, std::uint32_t queries, Buffer<std::uint32_t>& counts, const FindLists<T>& find) {
    if (queries == 0) return;
    if (!state_of(bvh).splits()) {
        find({}, {}, counts);
        return;
    }
    const CountedLists<T> lists = make_lists<T>(bvh, queries, find);
    detail::copy(bvh.device(), lists.counts.memory(), counts.memory(), lists.counts.bytes());
}

template CountedLists<Hit> make_lists(const Bvh&, std::uint32_t, const FindLists<Hit>&);
template CountedLists<std::uint32_t> make_lists(const Bvh&, std::uint32_t, const FindLists<std::uint32_t>&);
template void count_results(const Bvh&, std::uint32_t, Buffer<std::uint32_t>&, const FindLists<Hit>&);
template void count_results(const Bvh&, std::uint32_t, Buffer<std::uint32_t>&, const FindLists<std::uint32_t>&);

}  // namespace claray
