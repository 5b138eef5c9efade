// What all functions of claray.h share: handles, errors as codes, structs of several versions.
#pragma once

#include <claray.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "claray/error.hpp"
#include "claray/instances.hpp"
#include "claray/query.hpp"
#include "claray/query/lists.hpp"

struct claray_lines {
    std::vector<std::string> lines;
};
struct claray_device {
    claray::Device device;
    std::string extensions;
};
struct claray_bvh {
    claray::Bvh bvh;
};
struct claray_instances {
    claray::InstancedBvh bvh;
    std::size_t bottoms;
};
struct claray_query {
    claray_query_kind kind;
    claray::Query query;
    bool of_instances;
    claray::QueryOptions options;
    claray_visits* visits;                     // in host memory; null: none, or in a buffer
    claray::Buffer<std::uint32_t> ray_number;  // how many rays are traced; not allocated: all
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

[[noreturn]] inline void refuse(const std::string& what, const std::string& remedy = {}) {
    throw Error(ErrorKind::usage, what, remedy);
}

/// Throws ErrorKind::usage if the pointer is null.
template <class T>
T& required(T* pointer, const char* name) {
    if (pointer == nullptr) refuse(std::string(name) + " is NULL");
    return *pointer;
}

inline std::string text_of(const char* text) { return text ? text : ""; }

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
inline QueryKind kind_of(const claray_query_kind& kind) {
    const int number = number_of(kind);
    if (number != CLARAY_QUERY_CLOSEST && number != CLARAY_QUERY_ANY)
        refuse("kind is " + std::to_string(number), "use a claray_query_kind");
    return number == CLARAY_QUERY_ANY ? QueryKind::any : QueryKind::closest;
}
/// The options with their arrays on the device. `visits`: receives the memory of the host that gets them, or null.
[[nodiscard]] QueryOptions options_of(const Device& device, const claray_query_options* given, claray_visits** visits);
/// A query with the options, on the queue of `queue` or, if that is null, of the structure.
template <class Structure>
claray_query* query_of(const Structure& over, const claray_query_kind& kind, const claray_query_options* options,
                       claray_device* queue, bool of_instances);
/// Null: the defaults.
[[nodiscard]] Bvh::Config config_of(const claray_bvh_config* given, const Bvh::Config& standard = {});
[[nodiscard]] claray_bvh_config config_of(const Bvh::Config& config);
[[nodiscard]] std::span<const Ray> rays_of(const claray_ray* rays, std::size_t count);

/// The size of the caller's version of the struct. Throws ErrorKind::usage for one that is not initialised.
template <class Struct>
std::size_t struct_size(const Struct& given, const char* name) {
    const std::size_t size = given.struct_size;
    if (size < 2 * sizeof(std::size_t) || size > 4096)
        refuse(std::string(name) + ".struct_size is " + std::to_string(size), "set it to sizeof of the struct");
    return size;
}

/// Members that the caller's version does not have are 0. Throws ErrorKind::usage for a struct that is not initialised
/// or of a later version.
template <class Struct>
Struct versioned(const Struct* given, const char* name) {
    Struct known{};
    if (given == nullptr) return known;
    const std::size_t size = struct_size(*given, name);
    const auto* bytes = reinterpret_cast<const unsigned char*>(given);
    if (size > sizeof(Struct) &&
        std::any_of(bytes + sizeof(Struct), bytes + size, [](unsigned char b) { return b != 0; }))
        refuse(std::string(name) + " has members that this version of claray does not know",
               "install the claray that claray.h belongs to");
    std::memcpy(&known, given, std::min(size, sizeof(Struct)));
    return known;
}

/// Writes the members that the caller's version has.
template <class Struct>
void give(Struct* place, Struct known, const char* name) {
    known.struct_size = struct_size(required(place, name), name);
    std::memcpy(place, &known, std::min(known.struct_size, sizeof known));
}

template <class T>
std::span<const T> array(const T* data, std::size_t count, const char* name) {
    if (count != 0) static_cast<void>(required(data, name));
    return {data, count};
}

/// Memory of the caller for exactly `needed` elements.
template <class T>
std::span<T> room(T* data, std::size_t count, std::size_t needed, const char* name) {
    if (count != needed)
        refuse("count is " + std::to_string(count) + ", and " + name + " needs " + std::to_string(needed) +
               " elements");
    if (count != 0) static_cast<void>(required(data, name));
    return {data, count};
}

/// A buffer of the caller, retained.
template <class T>
Buffer<T> shared(const Device& device, void* memory, std::size_t count, const char* name) {
    if (memory == nullptr) refuse(std::string(name) + " is NULL");
    return Buffer<T>::adopt(device, static_cast<cl_mem>(memory), count);
}

template <class T>
std::vector<T> copied(const void* data, std::size_t count, const char* name) {
    const std::span<const T> given = array(static_cast<const T*>(data), count, name);
    return {given.begin(), given.end()};
}

/// Element `i` of a list of `what`, such as "lights".
template <class List>
auto& element(List& list, std::size_t i, const char* what, const char* name = "index") {
    if (i >= list.size())
        refuse(std::string(name) + " is " + std::to_string(i) + ", and there are " + std::to_string(list.size()) + " " +
               what);
    return list[i];
}

/// Replaces an element, or adds one.
template <class T>
void set_element(std::vector<T>& list, std::size_t i, T&& value, const char* what) {
    if (i == list.size())
        list.push_back(std::move(value));
    else
        element(list, i, what) = std::move(value);
}

/// Events of the caller, retained.
inline std::vector<cl::Event> events_of(std::span<const void* const> given, const char* name) {
    std::vector<cl::Event> events;
    for (const void* one : given) {
        if (one == nullptr) refuse(std::string(name) + " holds NULL");
        events.emplace_back(static_cast<cl_event>(const_cast<void*>(one)), true);
    }
    return events;
}
/// The caller releases it.
inline void hand_over(const cl::Event& event, void*& place) {
    clRetainEvent(event());
    place = event();
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

template <class Structure>
claray_query* query_of(const Structure& over, const claray_query_kind& kind, const claray_query_options* options,
                       claray_device* queue, bool of_instances) {
    const QueryKind known_kind = kind_of(kind);
    const Device& on = queue ? queue->device : over.device();
    claray_visits* visits = nullptr;
    QueryOptions all = options_of(over.device(), options, &visits);
    const claray_query_options known = versioned(options, "options");
    Buffer<std::uint32_t> rays;
    if (known.count_buffer) rays = Buffer<std::uint32_t>::adopt(on, static_cast<cl_mem>(known.count_buffer), 1);
    Query made(over, known_kind, all, on);
    return new claray_query{kind, std::move(made), of_instances, std::move(all), visits, std::move(rays)};
}

}  // namespace claray::capi
