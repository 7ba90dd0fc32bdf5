#include "pbrt/build/light_sampler_spec.h"

#include <algorithm>
#include <charconv>

#include "pbrt/build/collect.h"

namespace pbrt {
namespace {

/// Text of a flag, for errors with positions.
class FlagText {
  public:
    FlagText(const char *flag, const std::string &text)
        : source_(std::make_shared<SourceFile>(SourceFile{flag, text})) {}
    std::string_view Text() const { return source_->text; }
    /// `place`: in Text().
    FileLoc At(const char *place) const { return {source_, 1, int(place - source_->text.data())}; }

  private:
    std::shared_ptr<const SourceFile> source_;
};

struct Pieces {
    std::string_view sampler;
    bool mesh = false;
    std::optional<std::string_view> guide;
};

/// Start of "+mesh" or another "+word"; excludes numbers such as 1e+4.
size_t FindSuffix(std::string_view text, size_t from) {
    for (size_t at = text.find('+', from); at != std::string::npos; at = text.find('+', at + 1))
        if (at + 1 < text.size() && std::isalpha(static_cast<unsigned char>(text[at + 1]))) return at;
    return text.size();
}

constexpr std::string_view kMesh = "mesh";

Pieces Split(const FlagText &flag, DiagnosticSink &sink) {
    constexpr std::string_view kGuide = "guide:";
    const std::string_view text = flag.Text();
    size_t end = FindSuffix(text, 0);
    Pieces pieces;
    pieces.sampler = text.substr(0, end);
    while (end < text.size()) {
        const size_t begin = end + 1;
        end = FindSuffix(text, begin);
        const std::string_view word = text.substr(begin, end - begin);
        if (word == kMesh ? pieces.mesh : word.starts_with("guide") && pieces.guide)
            sink.Error(flag.At(word.data() - 1), "\"+{}\" is given twice.", word.substr(0, word.find(':')));
        if (word == kMesh) pieces.mesh = true;
        else if (word == "guide") pieces.guide = word.substr(word.size());
        else if (word.starts_with(kGuide)) pieces.guide = word.substr(kGuide.size());
        else
            sink.Error(flag.At(word.data() - 1), "\"+{}\" is unknown; {}a light sampler is written {}.", word,
                       OldNameHint("suffix", word.substr(0, word.find('='))), kLightChoiceSyntax);
    }
    return pieces;
}

/// Parses "key=value".
Param ReadOne(const FlagText &flag, const std::string &owner, const std::vector<ParamDoc> &docs,
              std::string_view item) {
    const FileLoc loc = flag.At(item.data());
    const size_t equals = item.find('=');
    const std::string_view key = item.substr(0, equals);
    const auto doc = std::ranges::find(docs, key, &ParamDoc::name);
    if (doc == docs.end()) {
        std::vector<std::string> keys;
        for (const ParamDoc &d : docs) keys.push_back(d.name);
        throw UserError(loc, "\"{}\" has no parameter \"{}\"; {}{}.", owner, key,
                        OldNameHint("parameter", fmt::format("{}.{}", owner, key)), ListChoices(key, keys));
    }
    if (equals == std::string::npos) throw UserError(loc, "expected \"{}=value\".", key);
    const std::string_view value = item.substr(equals + 1);
    Param p;
    p.name = fmt::format("{}.{}", owner, key);
    p.loc = loc;
    p.type = doc->types.front();
    bool good = true;
    auto number = [&](auto &out) {
        auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), out);
        good = error == std::errc() && end == value.data() + value.size();
    };
    if (p.type == ParamType::Integer) {
        number(p.ints.emplace_back());
    } else if (p.type == ParamType::Bool) {
        p.bools.push_back(value == "true");
        good = value == "true" || value == "false";
    } else if (p.type == ParamType::String) {
        p.strings.emplace_back(value);
    } else {
        number(p.floats.emplace_back());
    }
    if (!good)
        throw UserError(flag.At(value.data()), "\"{}\" is not a value of type {}{}.", value, doc->TypeText(),
                        value.find('=') == std::string::npos ? "" : "; commas separate parameters");
    return p;
}

/// Parses "key=value,...". Reports all errors.
void ReadKeys(const FlagText &flag, const std::string &owner, const std::vector<ParamDoc> &docs, std::string_view piece,
              ParamSet *params, DiagnosticSink &sink) {
    for (size_t begin = 0; begin <= piece.size();) {
        const size_t end = std::min(piece.find(',', begin), piece.size());
        Collect(sink, [&] {
            Param p = ReadOne(flag, owner, docs, piece.substr(begin, end - begin));
            if (params->Has(p.name)) throw UserError(p.loc, "\"{}\" is given twice.", p.name);
            params->Add(std::move(p));
        });
        begin = end + 1;
    }
}

/// Throws if a character other than ':' separates a valid name from parameters: "octree,floor=0.1". `colon`: length of
/// `piece` before the colon.
void CheckColon(const FlagText &flag, std::string_view piece, size_t colon, const auto &find) {
    const auto isOfNames = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_'; };
    const size_t stop = std::find_if_not(piece.begin(), piece.begin() + colon, isOfNames) - piece.begin();
    const std::string known(piece.substr(0, stop));
    const size_t keys = piece.find_first_not_of(",;=/( ", stop);
    if (keys == std::string::npos || known.empty() || stop == colon) return;
    find(known, flag.At(piece.data()));
    throw UserError(flag.At(piece.data() + stop),
                    "a colon separates the name from its parameters, and commas separate these: \"{}:{}\".", known,
                    piece.substr(keys));
}

/// Parses "name:key=value,..."; `find(name, loc)` returns the registry entry of a known name.
auto ReadPiece(const FlagText &flag, std::string_view piece, const auto &find, ParamSet *params, DiagnosticSink &sink) {
    const size_t colon = std::min(piece.find(':'), piece.size());
    decltype(&find("", FileLoc())) entry = nullptr;
    Collect(sink, [&] {
        CheckColon(flag, piece, colon, find);
        entry = &find(std::string(piece.substr(0, colon)), flag.At(piece.data()));
        if (colon < piece.size()) ReadKeys(flag, entry->name, entry->params, piece.substr(colon + 1), params, sink);
    });
    return entry;
}

constexpr const char *kGuideName = "guide";

/// Throws UserError in a build without path guiding.
const DirectionSamplings::Entry &FindGuide(const PluginRegistry &registry, const FileLoc &loc) {
    if (registry.directionSamplings.Has(kGuideName)) return registry.directionSamplings.Find(kGuideName);
    throw UserError("path guiding is an extension, which this program was built without (-DPBRT_EXT=OFF).", loc);
}

/// Warns about parameters that belong to another value of a choice such as "model" (ParamDoc::choice).
void WarnOfParamsWithoutEffect(const auto &entry, const ParamSet &params, DiagnosticSink &sink) {
    const auto find = [&](const ParamDoc &doc) { return params.Find(entry.name + "." + doc.name, doc.types.front()); };
    for (const ParamDoc &doc : entry.params) {
        const Param *p = find(doc);
        const auto choice = std::ranges::find(entry.params, doc.choice, &ParamDoc::name);
        if (!p || choice == entry.params.end()) continue;
        std::string chosen = choice->defaultValue;
        if (const Param *given = find(*choice); given && !given->strings.empty()) chosen = given->strings[0];
        else if (given && !given->bools.empty()) chosen = detail::ValueText(bool(given->bools[0]));
        if (doc.chosen != chosen)
            sink.Warning(p->loc, "\"{}\" has no effect: it belongs to {}={}, and {} is \"{}\" here.", doc.name,
                         choice->name, doc.chosen, choice->name, chosen);
    }
}

/// Parameters of the selected entry: the integrator's, overridden by the flag's. Values out of range are errors.
ParamSet ChosenParams(const char *family, const auto &entry, const ParamSet &integrator, const FileLoc &loc,
                      const ParamSet &added, DiagnosticSink &sink) {
    ParamSet params(fmt::format("{} \"{}\"", family, entry.name), loc);
    for (const ParamDoc &doc : entry.params)
        if (const Param *p = integrator.Find(entry.name + "." + doc.name, doc.types.front())) params.Add(*p);
    for (const Param &p : added.Own()) params.Add(p);
    if (entry.check) Collect(sink, [&] { entry.check(params); });
    WarnOfParamsWithoutEffect(entry, params, sink);
    return params;
}

}  // namespace

std::string WithoutMesh(std::string choice) {
    for (size_t begin = FindSuffix(choice, 0); begin < choice.size();) {
        const size_t end = FindSuffix(choice, begin + 1);
        if (std::string_view(choice).substr(begin + 1, end - begin - 1) == kMesh) choice.erase(begin, end - begin);
        else begin = end;
    }
    return choice;
}

void DeclareLightParams(ParamReader &reader, const PluginRegistry &registry, bool isGuided) {
    const auto declare = [&](const auto &table) {
        for (const std::string &name : table.Names())
            for (const ParamDoc &doc : table.Find(name).params)
                reader.Declare(name + "." + doc.name, doc.types.front());
    };
    declare(registry.samplers);
    if (isGuided) declare(registry.directionSamplings);
}

DirectionSpec ReadDirections(const ParamSet &integrator, const std::optional<ParamSet> &added,
                             const PluginRegistry &registry, DiagnosticSink &sink) {
    const FileLoc &loc = integrator.Loc();
    const DirectionSamplings::Entry &entry = FindGuide(registry, loc);
    return {&entry, ChosenParams("direction sampling", entry, integrator, loc, added.value_or(ParamSet()), sink)};
}

std::optional<LightSelection> ReadLightSelection(const ParamSet &integrator, const LightFlags &flags,
                                                 const PluginRegistry &registry, DiagnosticSink &sink,
                                                 const LightSelectionParams &defaults) {
    const size_t errorsBefore = sink.ErrorCount();
    LightSelection selection;
    auto &[sampler, guide] = selection;
    LightSelectionParams scene = defaults;
    ParamReader reader(integrator);
    scene.Describe(reader);
    Collect(sink, [&] { reader.ThrowIfErrors(); });

    const FlagText choice(flags.choiceFlag, flags.choice);
    const Pieces pieces = Split(choice, sink);
    ParamSet keys;
    auto find = [&](const std::string &n, const FileLoc &loc) -> const auto & {
        return registry.samplers.Find(n, loc);
    };

    // The scene's name is validated even if a flag overrides it.
    const FileLoc loc = integrator.LocOf("lightsampler");
    Collect(sink, [&] {
        const std::string &name = scene.lightSampler;
        if (const size_t stop = name.find_first_of(":,;=+ "); stop != std::string::npos)
            throw UserError(loc,
                            "\"{}\" is the form of flags; in a scene this is a name only, and its parameters "
                            "are such as \"float {}.floor\".",
                            Abbreviate(name), Abbreviate(name.substr(0, stop)));
        sampler.entry = &find(name, loc);
    });
    if (!flags.choice.empty()) sampler.entry = ReadPiece(choice, pieces.sampler, find, &keys, sink);
    if (sampler.entry) sampler.params = ChosenParams("light sampler", *sampler.entry, integrator, loc, keys, sink);

    if (pieces.guide) {
        guide.emplace("the guide", choice.At(pieces.guide->data()));
        Collect(sink, [&] {
            const auto &entry = FindGuide(registry, guide->Loc());
            if (pieces.guide->data()[-1] == ':')
                ReadKeys(choice, kGuideName, entry.params, *pieces.guide, &*guide, sink);
            entry.check(*guide);
        });
    }

    sampler.meshLights = scene.meshLights || flags.meshLights || pieces.mesh;
    // Samplers that do not accept groups form them themselves.
    if (sampler.entry && !sampler.entry->traits.takesGroups) {
        const Param *own = sampler.params.Find(sampler.entry->name + ".meshlights", ParamType::Bool);
        if ((flags.meshLights || pieces.mesh) && own && !own->bools[0])
            sink.Error(own->loc, "\"meshlights\" is false, but \"+mesh\" or --mesh-lights is given.");
        sampler.meshLights = false;
    }
    if (sink.ErrorCount() > errorsBefore) return {};
    return selection;
}

std::optional<LightSamplerSpec> ReadShootingSampler(const ParamSet &integrator, const std::string &named,
                                                    const std::string &flag, const PluginRegistry &registry,
                                                    DiagnosticSink &sink) {
    const size_t errorsBefore = sink.ErrorCount();
    const FlagText text("--shooting-sampler", flag);
    const auto find = [&](const std::string &name, const FileLoc &loc) -> const LightSamplerRegistry::Entry & {
        const std::vector<std::string> choices = registry.EmissionSamplerNames();
        if (registry.samplers.Has(name) && !registry.samplers.Find(name).traits.isSameEverywhere)
            throw UserError(loc,
                            "light sampler \"{}\" chooses by place, and light paths have none before they begin; {}.",
                            name, ListChoices(name, choices));
        if (!registry.samplers.Has(name)) ThrowUnknown("light sampler", name, choices, loc);
        return registry.samplers.Find(name, loc);
    };
    LightSamplerSpec spec;
    ParamSet keys;
    const FileLoc loc = integrator.LocOf("shootingsampler");
    // The scene's name is validated even if the flag overrides it.
    Collect(sink, [&] { spec.entry = &find(named, loc); });
    if (!flag.empty()) spec.entry = ReadPiece(text, text.Text(), find, &keys, sink);
    if (spec.entry) spec.params = ChosenParams("light sampler", *spec.entry, integrator, loc, keys, sink);
    if (sink.ErrorCount() > errorsBefore) return {};
    return spec;
}

}  // namespace pbrt
