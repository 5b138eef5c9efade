#include "host/bvh/reinsertion.hpp"

namespace claray {
namespace {

constexpr const char* reinsertion_file = "bvh/reinsertion.cl";
constexpr std::size_t reinsertion_group = 64;
constexpr std::size_t words_per_move = 4;

}  // namespace

Reinsertion::Reinsertion(const Device& device, std::uint32_t leaves)
    : leaves_(leaves),
      leaf_parents_(device, leaves),
      gains_(device, 2 * std::size_t(leaves)),
      owners_(device, 2 * std::size_t(leaves)),
      moves_(device, words_per_move * 2 * std::size_t(leaves)),
      find_leaf_parents_(load_kernel(device, reinsertion_file, "find_leaf_parents")),
      find_moves_(load_kernel(device, reinsertion_file, "find_moves")),
      claim_by_gain_(load_kernel(device, reinsertion_file, "claim_by_gain")),
      claim_by_id_(load_kernel(device, reinsertion_file, "claim_by_id")),
      find_winners_(load_kernel(device, reinsertion_file, "find_winners")),
      prevent_cycles_(load_kernel(device, reinsertion_file, "prevent_cycles")),
      apply_(load_kernel(device, reinsertion_file, "apply_moves")),
      update_(load_kernel(device, reinsertion_file, "update_nodes")) {}

void Reinsertion::run(const Buffer<BvhNode>& nodes, Buffer<std::uint32_t>& arrivals, const Buffer<BvhHeader>& header,
                      unsigned rounds, unsigned stride) {
    if (leaves_ < 4) return;
    const Range of_nodes{leaves_, reinsertion_group}, of_both{2 * std::size_t(leaves_), reinsertion_group};
    find_leaf_parents_.run(of_nodes, nodes, leaf_parents_, header);
    for (unsigned round = 0; round < rounds; ++round) {
        gains_.fill(0);
        owners_.fill(0xffffffffu);
        arrivals.fill(0);
        find_moves_.run(of_both, nodes, leaf_parents_, header, stride, round % stride, moves_.memory());
        claim_by_gain_.run(of_both, nodes, arg("leaf_parents", leaf_parents_), header, moves_.memory(),
                           arg("gains", gains_));
        claim_by_id_.run(of_both, nodes, arg("leaf_parents", leaf_parents_), header, moves_.memory(),
                         arg("gains", gains_), arg("owners", owners_));
        find_winners_.run(of_both, nodes, arg("leaf_parents", leaf_parents_), header, moves_.memory(),
                          arg("gains", gains_), arg("owners", owners_));
        prevent_cycles_.run(of_both, nodes, leaf_parents_, header, moves_.memory());
        apply_.run(of_both, nodes, leaf_parents_, header, moves_.memory());
        update_.run(of_nodes, nodes, arrivals, header);
    }
}

}  // namespace claray
