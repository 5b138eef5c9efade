// libFuzzer's entry to one target, FUZZ_TARGET.
#include <cstring>

#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto* const target = [] {
        for (const claray::test::FuzzTarget& each : claray::test::fuzz_targets())
            if (std::strcmp(each.name, FUZZ_TARGET) == 0) return &each;
        __builtin_trap();
    }();
    target->run({data, size});
    return 0;
}
