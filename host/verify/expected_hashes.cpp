#include "host/verify/expected_hashes.hpp"

#include <map>

namespace claray::verify {

std::string expected_hash(const std::string& name) {
    static const std::map<std::string, std::string> hashes = {
        {"tree soup fast", "9c56e54422f07c9c5404b80dc8834856"},
        {"tree soup balanced", "c04f3c2969ba0d5b1445b6390516de18"},
        {"tree soup high", "1c0956324c094fbdfb13b7dc1b0bb1bf"},
        {"tree sphere fast", "c652c1d46eaf8793089beba4395063ba"},
        {"tree sphere balanced", "94ed395911e41706a8f84182c371f67b"},
        {"tree sphere high", "600b597c9ad1ab2037b0497abf92d8a6"},
        {"tree grid fast", "011db37c9830c81682eb1cd73196ba97"},
        {"tree grid balanced", "f60528183607132171a1061e1ac74e21"},
        {"tree grid high", "fec411f76f43f0b5de6db73655373673"},
        {"tree hair fast", "203f5f3c61bc673ed3afc90ca069db8b"},
        {"tree hair balanced", "941e38677fb8fa56234d8c6894fdfe3b"},
        {"tree hair high", "eee4d0f13da2787e34b73ed0dc475540"},
        {"hits soup", "d003576538277500b117849d4465b25f"},
        {"hits sphere", "e02c6578d42b680a4efe3ca335d492a7"},
        {"hits grid", "e4bbe9bc424ddb6e632aedab90a7a9d6"},
        {"hits hair", "4ddacbbfbdfa68c326b556dc6920e721"},
    };
    const auto found = hashes.find(name);
    return found == hashes.end() ? std::string() : found->second;
}

}  // namespace claray::verify
