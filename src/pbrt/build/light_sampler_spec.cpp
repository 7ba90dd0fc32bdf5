#include "pbrt/build/light_sampler_spec.h"

#include <charconv>

namespace pbrt {

namespace {

/// "name:key=value,..." taken apart, with a located error for everything that does not fit.
class CommandLineSpec {
  public:
    CommandLineSpec(const char *flag, const std::string &text) {
        auto source = std::make_shared<SourceFile>();
        source->name = flag;
        source->text = text;
        source_ = source;
    }

    /// `find(name, loc)` gives the registry's entry.
    template <class Find>
    const auto &Read(const Find &find, ParamSet *params) const {
        const std::string &text = source_->text;
        size_t colon = text.find(':');
        const auto &entry = find(text.substr(0, colon), At(0));
        if (colon == std::string::npos) return entry;
        for (size_t begin = colon + 1; begin <= text.size();) {
            size_t end = std::min(text.find(',', begin), text.size());
            params->Add(ReadOne(entry.name, entry.params, begin, text.substr(begin, end - begin)));
            begin = end + 1;
        }
        return entry;
    }

  private:
    FileLoc At(size_t column) const { return {source_, 1, static_cast<int>(column)}; }

    Param ReadOne(const std::string &owner, const std::vector<ParamDoc> &docs, size_t column, const std::string &item) const {
        size_t equals = item.find('=');
        std::string key = item.substr(0, equals);
        const ParamDoc *doc = nullptr;
        std::vector<std::string> keys;
        for (const ParamDoc &d : docs) {
            keys.push_back(d.name);
            if (d.name == key) doc = &d;
        }
        if (!doc)
            throw UserError(fmt::format("\"{}\" has no parameter \"{}\"; {}.", owner, key, ListChoices(key, keys)),
                            At(column));
        if (equals == std::string::npos) throw UserError(fmt::format("expected \"{}=value\".", key), At(column));
        std::string value = item.substr(equals + 1);
        Param p;
        p.name = owner + "." + key;
        p.loc = At(column);
        bool good = false;
        auto number = [&](auto &out) {
            auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), out);
            return error == std::errc() && end == value.data() + value.size();
        };
        if (doc->type == "integer") {
            p.type = ParamType::Integer;
            good = number(p.ints.emplace_back());
        } else if (doc->type == "bool") {
            p.type = ParamType::Bool;
            p.bools.push_back(value == "true");
            good = value == "true" || value == "false";
        } else if (doc->type == "string") {
            p.type = ParamType::String;
            p.strings.push_back(value);
            good = true;
        } else {
            p.type = ParamType::Float;
            good = number(p.floats.emplace_back());
        }
        if (!good) throw UserError(fmt::format("\"{}\" is not a value of type {}.", value, doc->type), At(column + equals + 1));
        return p;
    }

    std::shared_ptr<const SourceFile> source_;
};

/// Marks the parameters "name.key" of an entry as known; those of the chosen one are copied.
void TakeParams(const ParamSet &integrator, const std::string &name, const std::vector<ParamDoc> &docs, ParamSet *chosen) {
    for (const ParamDoc &doc : docs) {
        ParamType type = doc.type == "integer"  ? ParamType::Integer
                         : doc.type == "bool"   ? ParamType::Bool
                         : doc.type == "string" ? ParamType::String
                                                : ParamType::Float;
        const Param *p = integrator.Find(name + "." + doc.name, type);
        if (p && chosen) chosen->Add(*p);
    }
}

}  // namespace

LightSamplerSpec ReadLightSamplerSpec(const ParamSet &integrator, const std::string &commandLine, bool meshLightsFlag,
                                      const LightSamplerRegistry &registry, const char *flag) {
    LightSamplerSpec spec;
    std::string name = integrator.GetString("lightsampler", "bvh");
    spec.entry = &registry.Find(name, integrator.LocOf("lightsampler"));
    spec.meshLights = registry.HasMeshGrouping() && integrator.GetBool("meshlights", false);
    ParamSet added;
    auto find = [&](const std::string &n, const FileLoc &loc) -> const auto & { return registry.Find(n, loc); };
    if (!commandLine.empty()) spec.entry = &CommandLineSpec(flag, commandLine).Read(find, &added);

    spec.params = ParamSet(fmt::format("light sampler \"{}\"", spec.entry->name), integrator.LocOf("lightsampler"));
    // Keys of samplers that are registered but not chosen are accepted, so that --lightsampler can switch.
    for (const std::string &known : registry.Names()) {
        const LightSamplerRegistry::Entry &entry = registry.Find(known);
        TakeParams(integrator, known, entry.params, &entry == spec.entry ? &spec.params : nullptr);
    }
    for (const Param &p : added.Own()) spec.params.Add(p);

    if (meshLightsFlag) {
        if (!registry.HasMeshGrouping()) throw UserError("--mesh-lights: this build has no mesh-light grouping.");
        spec.meshLights = true;
    }
    // A sampler that groups by itself needs no wrapper.
    if (!spec.entry->makeOverCandidates) spec.meshLights = false;
    return spec;
}

ShadowGateSpec ReadShadowGateSpec(const ParamSet &integrator, const std::string &commandLine,
                                  const LightSamplerRegistry &registry, const char *flag) {
    ShadowGateSpec spec;
    std::string name = integrator.GetString("shadowgate", "none");
    if (name != "none") spec.entry = &registry.FindGate(name, integrator.LocOf("shadowgate"));
    ParamSet added;
    auto find = [&](const std::string &n, const FileLoc &loc) -> const auto & { return registry.FindGate(n, loc); };
    if (commandLine == "none") spec.entry = nullptr;
    else if (!commandLine.empty()) spec.entry = &CommandLineSpec(flag, commandLine).Read(find, &added);
    if (spec.entry) spec.params = ParamSet(fmt::format("shadow-ray gate \"{}\"", spec.entry->name), integrator.LocOf("shadowgate"));
    for (const std::string &known : registry.GateNames()) {
        const LightSamplerRegistry::GateEntry &entry = registry.FindGate(known);
        TakeParams(integrator, known, entry.params, &entry == spec.entry ? &spec.params : nullptr);
    }
    for (const Param &p : added.Own()) spec.params.Add(p);
    return spec;
}

}  // namespace pbrt
