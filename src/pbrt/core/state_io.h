#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "pbrt/core/error.h"

namespace pbrt {

/// Hash against damage and changes by hand; not cryptographic.
inline uint64_t StructureHash(std::string_view bytes) {
    uint64_t hash = 0xcbf29ce484222325ull ^ bytes.size();
    for (size_t at = 0; at < bytes.size(); at += sizeof(uint64_t)) {
        uint64_t word = 0;
        std::memcpy(&word, bytes.data() + at, std::min(sizeof(word), bytes.size() - at));
        hash = (hash ^ word) * 0x9e3779b97f4a7c15ull;
        hash ^= hash >> 32;
    }
    return hash;
}

/// Serialises values bitwise in native byte order. Numbers, texts and copies are stored here. Vectors and data given to
/// Refer are only referenced, to avoid duplicating big arrays, and must not change until the last use of Pieces.
///
/// Learned structures declare their members once, in `void Visit(auto &archive)`, for StateWriter and StateReader. It
/// calls archive(member, ...) for trivially copyable values, texts, structures with Visit, and vectors, maps, optionals
/// and variants of these. Indices and offsets use archive.Structure(vector).
class StateWriter {
  public:
    template <class... T>
    void operator()(const T &...values) {
        (Save(values), ...);
    }
    template <class T>
    void Value(const T &value) {
        static_assert(std::is_trivially_copyable_v<T>);
        Copy(&value, sizeof(value));
    }
    /// A value plus a hash of its bytes, for indices, offsets and names: also detects valid changes.
    void Structure(const auto &values) {
        if constexpr (requires { values.data(); }) {
            Save(values);
            Value(StructureHash({reinterpret_cast<const char *>(values.data()), values.size() * sizeof(values[0])}));
        } else {
            StateWriter bytes;
            bytes(values);
            Structure(bytes.Joined());
        }
    }
    void Copy(const void *data, size_t bytes) {
        if (bytes == 0) return;
        if (!pieces_.empty() && !pieces_.back().data) pieces_.back().bytes += bytes;
        else pieces_.push_back({nullptr, copied_.size(), bytes});
        copied_.append(static_cast<const char *>(data), bytes);
    }
    void Refer(const void *data, size_t bytes) {
        if (bytes > 0) pieces_.push_back({static_cast<const char *>(data), 0, bytes});
    }

    /// All bytes in order, valid until the next addition.
    std::vector<std::string_view> Pieces() const {
        std::vector<std::string_view> views;
        for (const Piece &p : pieces_) views.emplace_back(p.data ? p.data : copied_.data() + p.at, p.bytes);
        return views;
    }
    uint64_t Bytes() const {
        uint64_t bytes = 0;
        for (const Piece &p : pieces_) bytes += p.bytes;
        return bytes;
    }
    std::string Joined() const {
        std::string all;
        all.reserve(Bytes());
        for (const std::string_view piece : Pieces()) all += piece;
        return all;
    }

  private:
    template <class T>
    void Save(const T &value) {
        // Visit serves reading and writing, hence is not const; this archive changes nothing.
        if constexpr (requires(T & v, StateWriter & archive) { v.Visit(archive); }) const_cast<T &>(value).Visit(*this);
        else Value(value);
    }
    /// Number of elements, then the elements; plain memory by reference.
    template <class T>
    void Save(const std::vector<T> &values) {
        Value(uint64_t{values.size()});
        if constexpr (std::is_trivially_copyable_v<T>) Refer(values.data(), values.size() * sizeof(T));
        else
            for (const T &value : values) Save(value);
    }
    template <class K, class V>
    void Save(const std::map<K, V> &values) {
        Value(uint64_t{values.size()});
        for (const auto &[key, value] : values) (*this)(key, value);
    }
    template <class T>
    void Save(const std::optional<T> &value) {
        Value(value.has_value());
        if (value) Save(*value);
    }
    template <class... T>
    void Save(const std::variant<T...> &value) {
        Value(uint64_t{value.index()});
        std::visit([this](const auto &v) { Save(v); }, value);
    }
    void Save(const std::string &text) {
        Value(uint64_t{text.size()});
        Copy(text.data(), text.size());
    }

    struct Piece {
        const char *data = nullptr;  ///< null: the bytes are in copied_
        size_t at = 0, bytes = 0;
    };
    std::vector<Piece> pieces_;
    std::string copied_;
};

/// Reads the output of StateWriter. Throws UserError where the bytes end too early; never reads out of bounds.
class StateReader {
  public:
    /// `what`: name for messages. `bytes` must outlive this object.
    StateReader(std::string_view bytes, std::string what) : rest_(bytes), what_(std::move(what)) {}

    /// Reads what StateWriter's operator() wrote. Structures with `std::optional<std::string> Validate() const` (an
    /// error or none) are validated once read.
    template <class... T>
    void operator()(T &...values) {
        (Load(values), ...);
    }
    template <class T>
    T Value() {
        static_assert(std::is_trivially_copyable_v<T>);
        if constexpr (std::is_same_v<T, bool>) {
            const auto byte = Value<uint8_t>();
            Require(byte <= 1, "a flag is neither 0 nor 1");
            return byte == 1;
        } else {
            T value;
            std::memcpy(&value, Take(sizeof(T)).data(), sizeof(T));
            return value;
        }
    }
    std::string Text() { return std::string(Take(Value<uint64_t>())); }
    void Structure(auto &values) {
        if constexpr (requires { values.data(); }) {
            Load(values);
            const char *bytes = reinterpret_cast<const char *>(values.data());
            Require(Value<uint64_t>() == StructureHash({bytes, values.size() * sizeof(values[0])}),
                    "the hash of a structure does not fit");
        } else {
            std::string bytes;
            Structure(bytes);
            StateReader in(bytes, what_);
            in(values);
            in.RequireEnd();
        }
    }
    std::string_view Take(uint64_t bytes) {
        Require(bytes <= rest_.size(), kTooShort);
        const std::string_view taken = rest_.substr(0, bytes);
        rest_.remove_prefix(bytes);
        return taken;
    }
    size_t BytesLeft() const { return rest_.size(); }
    const std::string &What() const { return what_; }
    /// Throws the error for corrupt data. `why`: a clause.
    [[noreturn]] void ThrowCorrupt(std::string_view why) const {
        throw UserError("{}: its content is damaged: {}.", what_, why);
    }
    void Require(bool isRight, std::string_view why) const {
        if (!isRight) ThrowCorrupt(why);
    }
    void RequireValid(const std::optional<std::string> &fault) const {
        if (fault) ThrowCorrupt(*fault);
    }
    void RequireEnd() const { Require(rest_.empty(), "it is longer than what it holds"); }

  private:
    template <class T>
    void Load(T &value) {
        if constexpr (requires { value.Visit(*this); }) value.Visit(*this);
        else value = Value<T>();
        if constexpr (requires { value.Validate(); }) RequireValid(value.Validate());
    }
    template <class T>
    void Load(std::vector<T> &values) {
        const auto count = Value<uint64_t>();
        if constexpr (std::is_trivially_copyable_v<T>) {
            Require(count <= rest_.size() / sizeof(T), kTooShort);
            const std::string_view bytes = Take(count * sizeof(T));
            values.resize(count);
            if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
        } else {
            values.clear();
            for (uint64_t i = 0; i < count; ++i) Load(values.emplace_back());
        }
    }
    template <class K, class V>
    void Load(std::map<K, V> &values) {
        values.clear();
        for (auto count = Value<uint64_t>(); count > 0; --count) {
            K key;
            Load(key);
            Load(values[key]);
        }
    }
    template <class T>
    void Load(std::optional<T> &value) {
        value.reset();
        if (Value<bool>()) Load(value.emplace());
    }
    template <class... T>
    void Load(std::variant<T...> &value) {
        const auto index = Value<uint64_t>();
        Require(index < sizeof...(T), "a value is of no known kind");
        size_t i = 0;
        ((i++ == index ? Load(value.template emplace<T>()) : void()), ...);
    }
    void Load(std::string &text) { text = Text(); }

    static constexpr std::string_view kTooShort = "it is shorter than what it announces";
    std::string_view rest_;
    std::string what_;
};

}  // namespace pbrt
