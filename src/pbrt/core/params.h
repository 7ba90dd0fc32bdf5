#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/float.h"

namespace pbrt {

/// Type keywords of parameter declarations (pbrt-v4-format §1).
enum class ParamType {
    Integer,
    Float,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal,
    Bool,
    String,
    Rgb,
    Blackbody,
    Spectrum,
    Texture
};

inline constexpr std::array<const char *, 13> kParamTypeNames = {
    "integer", "float",  "point2", "vector2",   "point3",   "vector3", "normal",
    "bool",    "string", "rgb",    "blackbody", "spectrum", "texture"};  ///< in that order
constexpr const char *Name(ParamType type) { return kParamTypeNames[size_t(type)]; }
/// Numbers per value: 2 or 3 for points, vectors, normals and rgb, else 1.
inline size_t ItemSize(ParamType type) {
    switch (type) {
        case ParamType::Point2:
        case ParamType::Vector2: return 2;
        case ParamType::Point3:
        case ParamType::Vector3:
        case ParamType::Normal:
        case ParamType::Rgb: return 3;
        default: return 1;
    }
}

/// Interval of valid values, closed unless an end is declared open.
template <class T>
struct Range {
    T low, high;
    bool openLow = false, openHigh = false;
    const char *unit = "";      ///< of the numbers, for messages and documentation
    bool Contains(T v) const {  // false for not-a-number
        return (openLow ? v > low : v >= low) && (openHigh ? v < high : v <= high);
    }
};
/// Values in (0, high].
constexpr Range<Float> Positive(Float high, const char *unit = "") { return {0, high, true, false, unit}; }
constexpr Range<Float> AnyFloat(const char *unit = "") {
    return {std::numeric_limits<Float>::lowest(), std::numeric_limits<Float>::max(), false, false, unit};
}

// Ranges shared by several parameters. docs/reference: parameters.md lists all ranges, compatibility.md other limits.

/// Embree drops vertices beyond sqrt(largest float) / 10 = 1.844e18 and rejects rays that start there. This bound on
/// coordinates keeps arbitrarily rotated instances below Embree's, and squared distances finite.
inline constexpr Float kMaxCoordinate = 1e18f;
inline constexpr Range<Float> kCoordinateRange{-kMaxCoordinate, kMaxCoordinate};
inline constexpr Range<Float> kLengthRange = Positive(kMaxCoordinate);

/// Upper bound of radiance, intensity, and factors that scale them.
inline constexpr Float kMaxBrightness = 1e30f;
inline constexpr Range<Float> kBrightnessRange{0, kMaxBrightness};
/// Power or illuminance of a scaled light; values <= 0 leave the light unscaled.
inline constexpr Range<Float> kPowerRange{-kMaxBrightness, kMaxBrightness};

/// Nesting limit of textures, material mixes and included files.
inline constexpr int kMaxNesting = 256;

/// "at least 0 and below 180 degrees"
template <class T>
std::string Text(const Range<T> &range) {
    return fmt::format("{} {} and {} {}{}{}", range.openLow ? "above" : "at least", range.low,
                       range.openHigh ? "below" : "at most", range.high, *range.unit ? " " : "", range.unit);
}

/// One parsed parameter. Exactly one value list is filled: integers for Integer; bools for Bool; strings for String,
/// Texture and named/file Spectrum; floats otherwise. Point/vector/rgb values are flattened.
struct Param {
    ParamType type = ParamType::Float;
    std::string name;
    FileLoc loc;  ///< of the declaration string
    std::vector<Float> floats;
    std::vector<int> ints;
    std::vector<std::string> strings;
    std::vector<uint8_t> bools;
    std::string colorSpace = "srgb";  ///< current where the parameter was read; used by Rgb only
    bool fromAttribute = false;       ///< Attribute default: never reported as unused

    void Visit(auto &archive) { archive(type, name, floats, ints, strings, bools, colorSpace); }
};

/// Parameters of one directive as written in the scene. Parameter structs (core/describe.h) interpret them through
/// ParamReader. As in stock pbrt-v4, name and type must both match, and the last of several equal ones applies.
class ParamSet {
  public:
    ParamSet() = default;
    /// `what` names the entity in messages, e.g. `Shape "sphere"`.
    ParamSet(std::string what, FileLoc loc) : what_(std::move(what)), loc_(std::move(loc)) {}

    void Add(Param p) { params_.push_back(std::move(p)); }
    /// Adds a default from an Attribute directive, used where the entity gives none; the last one applies.
    void AddDefault(Param p) {
        p.fromAttribute = true;
        defaults_.push_back(std::move(p));
    }

    const std::string &What() const { return what_; }
    const FileLoc &Loc() const { return loc_; }
    const std::vector<Param> &Own() const { return params_; }

    /// The applicable parameter of that name and type, or of any type; nullptr if there is none.
    const Param *Find(std::string_view name, std::optional<ParamType> type = {}) const {
        return FindIf(name, [type](ParamType t) { return !type || t == *type; });
    }
    /// The applicable one among the parameters of that name whose type satisfies `accepts`.
    const Param *FindIf(std::string_view name, auto accepts) const {
        for (const std::vector<Param> *list : {&params_, &defaults_})
            for (auto p = list->rbegin(); p != list->rend(); ++p)
                if (p->name == name && accepts(p->type)) return &*p;
        return nullptr;
    }
    bool Has(std::string_view name) const { return Find(name) != nullptr; }

    /// Throws UserError at parameter `name` if the value is outside the range.
    template <class T>
    void Require(std::string_view name, T value, const Range<T> &range) const {
        if (!range.Contains(value))
            throw UserError(LocOf(name), "{}: \"{}\" is {}; it must be {}.", what_, name, value, Text(range));
    }

    /// An error located at parameter `name`; the message begins with the entity's name.
    UserError Error(std::string_view name, std::string_view message) const {
        return UserError(LocOf(name), "{}: {}", what_, message);
    }
    template <class... T>
    UserError Error(std::string_view name, fmt::format_string<T...> format, T &&...values) const {
        return Error(name, fmt::format(format, std::forward<T>(values)...));
    }
    void Warn(DiagnosticSink &sink, std::string_view name, std::string_view message) const {
        sink.Warning(LocOf(name), "{}: {}", what_, message);
    }
    /// Runs `read`; errors without a location get that of parameter `name`.
    auto At(std::string_view name, auto &&read) const {
        try {
            return read();
        } catch (const UserError &e) {
            if (e.Diagnostics().front().loc) throw;
            throw Error(name, e.Diagnostics().front().message);
        }
    }

    /// Declaration of parameter `name` if given, else the directive.
    FileLoc LocOf(std::string_view name) const {
        const Param *p = Find(name);
        return p ? p->loc : loc_;
    }
    /// Locations and defaults are not saved.
    void Visit(auto &archive) { archive(what_, params_); }

  private:
    std::string what_;
    FileLoc loc_;
    std::vector<Param> params_, defaults_;
};

}  // namespace pbrt
