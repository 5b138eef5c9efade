#include "host/verify/cases/expected_hashes.hpp"

#include <map>

namespace claray::verify {

std::string expected_hash(const std::string& name) {
    static const std::map<std::string, std::string> hashes = {
        {"tree soup fast", "463901572a4fb168da072f8a408aed1b"},
        {"tree soup balanced", "9e25db2bd67972aa863ac919592416e7"},
        {"tree soup high", "8061b42fdcf2c29c5758364c242a5a1f"},
        {"tree soup binned", "cc8b876dfbbaaa8a75707db447ca0c50"},
        {"tree sphere fast", "ea639ee05809047f4b8c06f2e9b02c44"},
        {"tree sphere balanced", "bdef2043679775be43f6376998a2ed47"},
        {"tree sphere high", "e438fd9918eba66729109ff27a943879"},
        {"tree sphere binned", "e438fd9918eba66729109ff27a943879"},
        {"tree grid fast", "538017076409d423c56109824c9ee5c0"},
        {"tree grid balanced", "c14ee81c9d308aa02bb91bbef4efd534"},
        {"tree grid high", "e7d64e489a538ccabf834c4a26c27683"},
        {"tree grid binned", "e7d64e489a538ccabf834c4a26c27683"},
        {"tree hair fast", "9e0803107d90fe99e6576b82321e6fc8"},
        {"tree hair balanced", "f81cdae93203d837ab9edf62b43b92eb"},
        {"tree hair high", "5d1634ad71f668f6c26982b258a4ac06"},
        {"tree hair binned", "d143981dbbd457adedda35d1faefe770"},
        {"hits soup", "d003576538277500b117849d4465b25f"},
        {"hits sphere", "e02c6578d42b680a4efe3ca335d492a7"},
        {"hits grid", "e4bbe9bc424ddb6e632aedab90a7a9d6"},
        {"hits hair", "4ddacbbfbdfa68c326b556dc6920e721"},
        {"tree walls fast", "3a52c0e0f74a1cf1b93b73e2baa49443"},
        {"tree walls balanced", "696f676ef940f1c1bf1d34c1267feef3"},
        {"tree walls high", "4327c172b4d045d90171585e79dae57a"},
        {"tree walls binned", "4327c172b4d045d90171585e79dae57a"},
        {"tree needles fast", "7231e67f7afd22b4791bd886c3f85403"},
        {"tree needles balanced", "6aba79d7481159cfed28c82acc54fcd6"},
        {"tree needles high", "4a62d2630a141ffdec54ee62fb783dd5"},
        {"tree needles binned", "c1610569734ba2c5393350bf54ee4b0c"},
        {"tree shards fast", "cfeb64023d682268a79808db100b364b"},
        {"tree shards balanced", "d748ec48adda9ac5f60e82162fdcca44"},
        {"tree shards high", "594490d4d9242a2cfe86faddc9077ff2"},
        {"tree shards binned", "fdf86881d19d4e13d18202807230a69f"},
        {"hits walls", "bda57ba4b4ce33e4c2af2f9a0289d89c"},
        {"hits needles", "a2435036857ea3b6858e7a0c0f307a5b"},
        {"hits shards", "bec63c1d815e16f7d74229a8ec4143e5"},
    };
    const auto found = hashes.find(name);
    return found == hashes.end() ? std::string() : found->second;
}

}  // namespace claray::verify
