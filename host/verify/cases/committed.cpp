#include "host/verify/cases/committed.hpp"

#include <map>

namespace claray::verify {

std::string committed_hash(const std::string& name) {
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
        {"tree shards fast", "cfeb64023d682268a79808db100b364b"},
        {"tree shards balanced", "d748ec48adda9ac5f60e82162fdcca44"},
        {"tree shards high", "594490d4d9242a2cfe86faddc9077ff2"},
        {"tree shards binned", "fdf86881d19d4e13d18202807230a69f"},
        {"hits shards", "bec63c1d815e16f7d74229a8ec4143e5"},
        {"tree walls fast", "ad42758d9dd879db6c457d361a530ec5"},
        {"tree walls balanced", "a9d730a7d8b59d1e4b588a88a8acfc47"},
        {"tree walls high", "1fd4ec4dc723eb7ac68efc7f1d0b4e4d"},
        {"tree walls binned", "7aff11cf7c00695195c9b30b5a1290f4"},
        {"tree tiny fast", "012cec1c5fece8de2cd646b2b3fbeb37"},
        {"tree tiny balanced", "1399f9f4715cc3cd9d3254b627d23430"},
        {"tree tiny high", "c35f66449c9d1cdd78005156e2715c75"},
        {"tree tiny binned", "d115739acee0c95a93b890216b796852"},
        {"tree mirrored fast", "8a899b448fa426d4af8d74543535309f"},
        {"tree mirrored balanced", "7a0f1bcf43b7918e765958ab0fd5ed8f"},
        {"tree mirrored high", "3b8cbcc72177038db2901ca69c7f368a"},
        {"tree mirrored binned", "a7355fc9b6224a0a7d6ca30d4fb3dff5"},
        {"hits walls", "4ca3815e84b35f95eb8fa5ca98b9634c"},
        {"hits mirrored", "174e797ec0595ecf9d77bf0724a52998"},
        {"tree huge fast", "20b7e35140b95efb1394c6c2188ff85c"},
        {"tree huge balanced", "8ba229d05043f0ac688c2f20e0d78112"},
        {"tree huge high", "4ded717daf8bb990564bc6e6f269c7f1"},
        {"tree huge binned", "4ded717daf8bb990564bc6e6f269c7f1"},
    };
    const auto found = hashes.find(name);
    return found == hashes.end() ? std::string() : found->second;
}

void Committed::compare_hash(const std::string& name, const std::string& hash) {
    const bool right = hash == committed_hash(name);
    tally_.add(right);
    if (!right) run_.failure(name + " has the hash " + hash);
}

}  // namespace claray::verify
