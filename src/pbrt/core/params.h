#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/float.h"

namespace pbrt {

/// The type words a parameter declaration may start with (pbrt-v4-format §1).
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

/// "integer", "float", ...
const char *Name(ParamType type);
/// How many numbers one value of the type has: 2 or 3 for points, vectors, normals and rgb, else 1.
size_t ItemSize(ParamType type);

/// The interval of the values that a number may have; it includes its ends unless they are open.
template <class T>
struct Range {
    T low, high;
    bool openLow = false, openHigh = false;
    const char *unit = "";      ///< of the numbers, for messages and documentation
    bool Contains(T v) const {  // false for not-a-number
        return (openLow ? v > low : v >= low) && (openHigh ? v < high : v <= high);
    }
};
/// Above 0 and at most `high`.
constexpr Range<Float> Positive(Float high, const char *unit = "") { return {0, high, true, false, unit}; }
constexpr Range<Float> AnyFloat(const char *unit = "") {
    return {std::numeric_limits<Float>::lowest(), std::numeric_limits<Float>::max(), false, false, unit};
}

/// "at least 0 and below 180 degrees"
template <class T>
std::string Text(const Range<T> &range) {
    return fmt::format("{} {} and {} {}{}{}", range.openLow ? "above" : "at least", range.low,
                       range.openHigh ? "below" : "at most", range.high, *range.unit ? " " : "", range.unit);
}

/// One parsed parameter. Exactly one of the value lists is filled: integers for Integer; bools for Bool; strings
/// for String, Texture and named/file Spectrum; floats for everything else. Point/vector/rgb values are flattened.
struct Param {
    ParamType type = ParamType::Float;
    std::string name;
    FileLoc loc;  ///< of the declaration string
    std::vector<Float> floats;
    std::vector<int> ints;
    std::vector<std::string> strings;
    std::vector<uint8_t> bools;
    std::string colorSpace = "srgb";  ///< in force where the parameter was read; used by Rgb only
    bool fromAttribute = false;       ///< an Attribute default: never reported as unused
};

/// The parameters of one directive, as they stand in the scene. Their meaning is declared by parameter structs
/// (core/describe.h), which ParamReader reads. As in stock pbrt-v4, name and type must both match, and the last of
/// several equal ones counts.
class ParamSet {
  public:
    ParamSet() = default;
    /// `what` names the entity in messages, e.g. `Shape "sphere"`.
    ParamSet(std::string what, FileLoc loc) : what_(std::move(what)), loc_(std::move(loc)) {}

    /// The entity's own parameters.
    void Add(Param p) { params_.push_back(std::move(p)); }
    /// Defaults from Attribute directives: searched only when the entity itself does not give the parameter; the last
    /// one added counts.
    void AddDefault(Param p) {
        p.fromAttribute = true;
        defaults_.push_back(std::move(p));
    }

    const std::string &What() const { return what_; }
    const FileLoc &Loc() const { return loc_; }
    const std::vector<Param> &Own() const { return params_; }

    /// The parameter of that name and type that counts; nullptr if there is none.
    const Param *Find(std::string_view name, ParamType type) const;
    /// True if a parameter of that name exists with any type.
    bool Has(std::string_view name) const;

    /// Throws UserError, located at the parameter `name`, if the value is outside the range.
    template <class T>
    void Require(std::string_view name, T value, const Range<T> &range) const {
        if (!range.Contains(value))
            throw UserError(fmt::format("{}: \"{}\" is {}; it must be {}.", what_, name, value, Text(range)),
                            LocOf(name));
    }

    /// An error located at the parameter `name`; the message begins with the name of the entity.
    UserError Error(std::string_view name, std::string_view message) const;
    void Warn(DiagnosticSink &sink, std::string_view name, std::string_view message) const;
    /// Runs `read`; errors that it throws without a location get that of the parameter `name`.
    template <class F>
    auto At(std::string_view name, F &&read) const {
        try {
            return read();
        } catch (const UserError &e) {
            if (e.Diagnostics().front().loc) throw;
            throw Error(name, e.Diagnostics().front().message);
        }
    }

    /// The location for messages about `name`: its declaration if the parameter is given, else the directive.
    FileLoc LocOf(std::string_view name) const;

  private:
    std::string what_;
    FileLoc loc_;
    std::vector<Param> params_;
    std::vector<Param> defaults_;
};

}  // namespace pbrt
