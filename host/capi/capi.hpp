// What all functions of claray.h share: handles, errors as codes, structs of several versions.
#pragma once

#include <claray.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <string>

#include "claray/error.hpp"
#include "claray/instances.hpp"
#include "claray/query.hpp"

struct claray_device {
    claray::Device device;
};
struct claray_bvh {
    claray::Bvh bvh;
};
struct claray_query {
    claray_query_kind kind;
    claray::Query query;
    bool of_instances;
};

namespace claray::capi {

/// Keeps the text for claray_last_error.
claray_status fail(claray_status status, const std::string& text) noexcept;

/// Calls `work`; exceptions become codes.
template <class Work>
claray_status guarded(const Work& work) noexcept {
    try {
        work();
        return CLARAY_OK;
    } catch (const Error& error) {
        return fail(claray_status(error.kind()), error.what());
    } catch (const std::bad_alloc&) {
        return fail(CLARAY_ERROR_INTERNAL, "out of host memory");
    } catch (const std::exception& error) {
        return fail(CLARAY_ERROR_INTERNAL, error.what());
    }
}

/// Throws ErrorKind::usage if the pointer is null.
template <class T>
T& required(T* pointer, const char* name) {
    if (pointer == nullptr) throw Error(ErrorKind::usage, std::string(name) + " is NULL");
    return *pointer;
}

/// Writes the handle that `make` returns to `place`. Makes none if there is no place, since it would leak.
template <class Handle, class Make>
void hand_out(Handle** place, const char* name, const Make& make) {
    Handle*& free = required(place, name);
    free = make();
}

/// The number of an enumerator of claray.h. Programs in C may pass any number, which C++ must not read as the
/// enumeration.
template <class Enum>
int number_of(const Enum& value) {
    int number = 0;
    static_assert(sizeof number == sizeof value);
    std::memcpy(&number, &value, sizeof number);
    return number;
}

/// Throws ErrorKind::usage for numbers that no version has.
[[nodiscard]] QueryKind kind_of(const claray_query_kind& kind);
[[nodiscard]] QueryOptions options_of(const claray_query_options* given);

/// Members that the caller's version does not have are 0. Throws ErrorKind::usage for a struct that is not initialised
/// or of a later version.
template <class Struct>
Struct versioned(const Struct* given, const char* name) {
    Struct known{};
    if (given == nullptr) return known;
    const std::size_t size = given->struct_size;
    if (size < 2 * sizeof(std::size_t) || size > 4096)
        throw Error(ErrorKind::usage, std::string(name) + ".struct_size is " + std::to_string(size),
                    "set it to sizeof of the struct");
    const auto* bytes = reinterpret_cast<const unsigned char*>(given);
    if (size > sizeof(Struct) &&
        std::any_of(bytes + sizeof(Struct), bytes + size, [](unsigned char b) { return b != 0; }))
        throw Error(ErrorKind::usage, std::string(name) + " has members that this version of claray does not know",
                    "install the claray that claray.h belongs to");
    std::memcpy(&known, given, std::min(size, sizeof(Struct)));
    return known;
}

template <class T>
std::span<const T> array(const T* data, std::size_t count, const char* name) {
    if (count != 0) static_cast<void>(required(data, name));
    return {data, count};
}

/// Runs `query(given, results)` with what is asked and `count` answers in buffers, which on CPUs are the caller's
/// memory.
template <class T, class Answer, class Query>
void answer(const Device& device, std::span<const T> asked, Answer* answers, std::size_t count, const char* name,
            const Query& query) {
    const std::span found(&required(answers, name), count);
    auto results = Buffer<Answer>::under(device, found);
    query(Buffer<T>::over(device, asked), results);
    results.fetch(found);
}

}  // namespace claray::capi
