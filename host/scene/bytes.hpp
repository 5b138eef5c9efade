// Values as bytes, for messages between processes of one version on machines of one byte order.
#pragma once

#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "claray/error.hpp"
#include "host/scene/members.hpp"

namespace claray {

template <class T>
concept Plain = std::is_trivially_copyable_v<T>;

class ByteWriter {
public:
    template <class... T>
    void add(const T&... values) {
        (put(values), ...);
    }
    [[nodiscard]] std::string take() { return std::move(bytes_); }

private:
    void raw(const void* data, std::size_t bytes) { bytes_.append(static_cast<const char*>(data), bytes); }
    template <Plain T>
    void put(const T& value) {
        raw(&value, sizeof value);
    }
    void put(const std::string& text) {
        put(std::uint64_t(text.size()));
        raw(text.data(), text.size());
    }
    template <class T>
    void put(const std::vector<T>& values) {
        put(std::uint64_t(values.size()));
        if constexpr (Plain<T>)
            raw(values.data(), values.size() * sizeof(T));
        else
            for (const T& value : values) put(value);
    }
    void put(const std::set<std::string>& texts) { put(std::vector<std::string>(texts.begin(), texts.end())); }
    template <class A, class B>
    requires(!Plain<std::pair<A, B>>) void put(const std::pair<A, B>& pair) { add(pair.first, pair.second); }
    template <class T>
    requires(Described<T> && !Plain<T>) void put(const T& value) {
        visit_members(value, [&](const auto&... members) { add(members...); });
    }

    std::string bytes_;
};

/// About bytes that no process of this version sends.
[[noreturn]] inline void refuse_message(const std::string& why) {
    throw Error(ErrorKind::user, "a message of another process " + why);
}

/// Throws ErrorKind::user if the bytes end too early.
class ByteReader {
public:
    explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

    template <class... T>
    void get(T&... values) {
        (take(values), ...);
    }
    /// Throws ErrorKind::user if bytes are left.
    void finish() const {
        if (!bytes_.empty()) refuse_message("is too long");
    }

private:
    void raw(void* data, std::size_t bytes) {
        if (bytes > bytes_.size()) refuse_message("ends too early");
        if (bytes > 0) std::memcpy(data, bytes_.data(), bytes);
        bytes_.remove_prefix(bytes);
    }
    [[nodiscard]] std::size_t count(std::size_t least_bytes) {
        std::uint64_t count = 0;
        take(count);
        if (count > bytes_.size() / least_bytes) refuse_message("ends too early");
        return std::size_t(count);
    }
    template <Plain T>
    void take(T& value) {
        raw(&value, sizeof value);
    }
    void take(std::string& text) {
        text.resize(count(1));
        raw(text.data(), text.size());
    }
    template <class T>
    void take(std::vector<T>& values) {
        if constexpr (Plain<T>) {
            values.resize(count(sizeof(T)));
            raw(values.data(), values.size() * sizeof(T));
        } else {
            values.clear();
            for (std::size_t left = count(1); left > 0; --left)
                take(values.emplace_back());  // a wrong count ends early
        }
    }
    void take(std::set<std::string>& texts) {
        std::vector<std::string> list;
        take(list);
        texts = {list.begin(), list.end()};
    }
    template <class A, class B>
    requires(!Plain<std::pair<A, B>>) void take(std::pair<A, B>& pair) { get(pair.first, pair.second); }
    template <class T>
    requires(Described<T> && !Plain<T>) void take(T& value) {
        visit_members(value, [&](auto&... members) { get(members...); });
    }

    std::string_view bytes_;
};

}  // namespace claray
