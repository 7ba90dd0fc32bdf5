#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/math/vec.h"

namespace pbrt::test {

/// Parameters as a scene file would give them; line numbers count the parameters.
class Params {
  public:
    /// The directive is at line 100, the first parameter at line 1.
    explicit Params(std::string what = "Entity \"test\"") : Params(std::move(what), 100) { lines_ = 0; }
    /// The first parameter is at the line behind the directive's.
    Params(std::string what, int line)
        : file_(std::make_shared<SourceFile>(SourceFile{"test.pbrt", ""})), lines_(line),
          set_(std::move(what), Loc(line)) {}
    Params &Floats(ParamType type, const std::string &name, std::vector<Float> v) {
        Param p = Make(type, name);
        p.floats = std::move(v);
        set_.Add(std::move(p));
        return *this;
    }
    Params &Integers(const std::string &name, std::vector<int> v) {
        Param p = Make(ParamType::Integer, name);
        p.ints = std::move(v);
        set_.Add(std::move(p));
        return *this;
    }
    Params &Integer(const std::string &name, int v) { return Integers(name, {v}); }
    /// As an Attribute directive gives it.
    Params &Default(ParamType type, const std::string &name, std::vector<Float> v) {
        Param p = Make(type, name);
        p.floats = std::move(v);
        set_.AddDefault(std::move(p));
        return *this;
    }
    Params &Number(const std::string &name, Float v) { return Floats(ParamType::Float, name, {v}); }
    Params &Point(const std::string &name, Point3 v) { return Floats(ParamType::Point3, name, {v.x, v.y, v.z}); }
    Params &Rgb(const std::string &name, Float r, Float g, Float b) { return Floats(ParamType::Rgb, name, {r, g, b}); }
    Params &String(const std::string &name, std::string v) {
        Param p = Make(ParamType::String, name);
        p.strings = {std::move(v)};
        set_.Add(std::move(p));
        return *this;
    }
    Params &Bool(const std::string &name, bool v) {
        Param p = Make(ParamType::Bool, name);
        p.bools = {static_cast<uint8_t>(v)};
        set_.Add(std::move(p));
        return *this;
    }
    const ParamSet &Set() const { return set_; }
    operator const ParamSet &() const { return set_; }

  private:
    FileLoc Loc(int line) const { return {file_, line, 4}; }
    Param Make(ParamType type, const std::string &name) {
        Param p;
        p.type = type;
        p.name = name;
        p.loc = Loc(++lines_);
        return p;
    }
    std::shared_ptr<SourceFile> file_;
    int lines_;
    ParamSet set_;
};

}  // namespace pbrt::test
