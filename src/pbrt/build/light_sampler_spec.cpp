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
    const std::string &Text() const { return source_->text; }
    FileLoc At(size_t column) const { return {source_, 1, static_cast<int>(column)}; }

  private:
    std::shared_ptr<const SourceFile> source_;
};

/// Characters [begin, end) of a flag's text.
struct Piece {
    size_t begin = 0, end = 0;
    std::string Of(const std::string &text) const { return text.substr(begin, end - begin); }
};

struct Pieces {
    Piece sampler;
    bool mesh = false;
    std::optional<Piece> guide;
};

/// Start of "+mesh" or another "+word"; excludes numbers such as 1e+4.
size_t FindSuffix(const std::string &text, size_t from) {
    for (size_t at = text.find('+', from); at != std::string::npos; at = text.find('+', at + 1))
        if (at + 1 < text.size() && std::isalpha(static_cast<unsigned char>(text[at + 1]))) return at;
    return text.size();
}

Pieces Split(const FlagText &flag, DiagnosticSink &sink) {
    static const std::string kGuide = "guide:";
    const std::string &text = flag.Text();
    Pieces pieces;
    pieces.sampler = {0, FindSuffix(text, 0)};
    for (size_t at = pieces.sampler.end, end; at < text.size(); at = end) {
        end = FindSuffix(text, at + 1);
        const std::string word = text.substr(at + 1, end - at - 1);
        if (word == "mesh") pieces.mesh = true;
        else if (word == "guide") pieces.guide = Piece{end, end};
        else if (word.starts_with(kGuide)) pieces.guide = Piece{at + 1 + kGuide.size(), end};
        else
            sink.Error(flag.At(at),
                       fmt::format("\"+{}\" is unknown; a light sampler is written {}.", word, kLightChoiceSyntax));
    }
    return pieces;
}

Param ReadOne(const FlagText &flag, const std::string &owner, const std::vector<ParamDoc> &docs, const Piece &piece) {
    const std::string item = piece.Of(flag.Text());
    const size_t equals = item.find('=');
    const std::string key = item.substr(0, equals);
    const ParamDoc *doc = nullptr;
    std::vector<std::string> keys;
    for (const ParamDoc &d : docs) {
        keys.push_back(d.name);
        if (d.name == key) doc = &d;
    }
    if (!doc)
        throw UserError(fmt::format("\"{}\" has no parameter \"{}\"; {}.", owner, key, ListChoices(key, keys)),
                        flag.At(piece.begin));
    if (equals == std::string::npos) throw UserError(fmt::format("expected \"{}=value\".", key), flag.At(piece.begin));
    const std::string value = item.substr(equals + 1);
    Param p;
    p.name = owner + "." + key;
    p.loc = flag.At(piece.begin);
    p.type = doc->types.front();
    bool good = false;
    auto number = [&](auto &out) {
        auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), out);
        return error == std::errc() && end == value.data() + value.size();
    };
    if (p.type == ParamType::Integer) {
        good = number(p.ints.emplace_back());
    } else if (p.type == ParamType::Bool) {
        p.bools.push_back(value == "true");
        good = value == "true" || value == "false";
    } else if (p.type == ParamType::String) {
        p.strings.push_back(value);
        good = true;
    } else {
        good = number(p.floats.emplace_back());
    }
    if (!good)
        throw UserError(fmt::format("\"{}\" is not a value of type {}{}.", value, doc->TypeText(),
                                    value.find('=') == std::string::npos ? "" : "; commas separate parameters"),
                        flag.At(piece.begin + equals + 1));
    return p;
}

/// Parses "key=value,...". Reports all errors.
void ReadKeys(const FlagText &flag, const std::string &owner, const std::vector<ParamDoc> &docs, const Piece &piece,
              ParamSet *params, DiagnosticSink &sink) {
    for (size_t begin = piece.begin; begin <= piece.end;) {
        const size_t end = std::min(flag.Text().find(',', begin), piece.end);
        Collect(sink, [&] { params->Add(ReadOne(flag, owner, docs, {begin, end})); });
        begin = end + 1;
    }
}

/// Throws if a character other than ':' separates a valid name from parameters: "octree,floor=0.1". `name`: everything
/// before the colon.
void CheckColon(const FlagText &flag, const Piece &name, size_t end, const auto &find) {
    const std::string &text = flag.Text();
    const auto isOfNames = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_'; };
    const auto stop = std::find_if_not(text.begin() + name.begin, text.begin() + name.end, isOfNames) - text.begin();
    const std::string known = text.substr(name.begin, stop - name.begin);
    const size_t keys = text.find_first_not_of(",;=/( ", stop);
    if (keys >= end || known.empty() || static_cast<size_t>(stop) == name.end) return;
    find(known, flag.At(name.begin));
    throw UserError(fmt::format("a colon separates the name from its parameters, and commas separate these: \"{}:{}\".",
                                known, text.substr(keys, end - keys)),
                    flag.At(stop));
}

/// Splits "name:key=value,..."; `find(name, loc)` returns the registry entry of a known name.
auto ReadPiece(const FlagText &flag, const Piece &piece, const auto &find, ParamSet *params, DiagnosticSink &sink) {
    const std::string &text = flag.Text();
    const size_t colon = std::min(text.find(':', piece.begin), piece.end);
    decltype(&find("", FileLoc())) entry = nullptr;
    Collect(sink, [&] {
        CheckColon(flag, {piece.begin, colon}, piece.end, find);
        entry = &find(text.substr(piece.begin, colon - piece.begin), flag.At(piece.begin));
        if (colon < piece.end) ReadKeys(flag, entry->name, entry->params, {colon + 1, piece.end}, params, sink);
    });
    return entry;
}

constexpr const char *kGuideName = "guide";

/// Parameters of the selected entry: the integrator's, overridden by the flag's. Values out of range are errors.
ParamSet ChosenParams(const std::string &owner, const auto &entry, const ParamSet &integrator, const FileLoc &loc,
                      const ParamSet &added, DiagnosticSink &sink) {
    ParamSet params(owner, loc);
    for (const ParamDoc &doc : entry.params)
        if (const Param *p = integrator.Find(entry.name + "." + doc.name, doc.types.front())) params.Add(*p);
    for (const Param &p : added.Own()) params.Add(p);
    if (entry.check) Collect(sink, [&] { entry.check(params); });
    return params;
}

ParamSet LightParams(const LightSamplerRegistry::Entry &entry, const ParamSet &integrator, const FileLoc &loc,
                     const ParamSet &added, DiagnosticSink &sink) {
    return ChosenParams(fmt::format("light sampler \"{}\"", entry.name), entry, integrator, loc, added, sink);
}

/// Warns about parameters that belong to another value of a choice such as "model" (ParamDoc::choice).
void WarnOfParamsWithoutEffect(const LightSamplerRegistry::Entry &entry, const ParamSet &params, DiagnosticSink &sink) {
    for (const ParamDoc &choice : entry.params) {
        if (choice.choices.empty()) continue;
        const Param *given = params.Find(entry.name + "." + choice.name, ParamType::String);
        const std::string &chosen = given && !given->strings.empty() ? given->strings[0] : choice.defaultValue;
        for (const ParamDoc &doc : entry.params) {
            if (doc.choice != choice.name || doc.chosen == chosen) continue;
            if (const Param *p = params.Find(entry.name + "." + doc.name, doc.types.front()))
                sink.Warning(p->loc, fmt::format("\"{}\" has no effect: it belongs to {}={}, and {} is \"{}\" here.",
                                                 doc.name, choice.name, doc.chosen, choice.name, chosen));
        }
    }
}

}  // namespace

LightChoiceText SplitLightChoice(const std::string &choice, const char *flag) {
    DiagnosticSink sink;
    const Pieces pieces = Split(FlagText(flag, choice), sink);
    sink.ThrowIfErrors();
    LightChoiceText parts{pieces.sampler.Of(choice), pieces.mesh, {}};
    if (pieces.guide) parts.guide = pieces.guide->Of(choice);
    return parts;
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

namespace {
/// Throws UserError in a build without path guiding.
const DirectionSamplings::Entry &FindGuide(const PluginRegistry &registry, const FileLoc &loc) {
    if (registry.directionSamplings.Has(kGuideName)) return registry.directionSamplings.Find(kGuideName);
    throw UserError("path guiding is an extension, which this program was built without (-DPBRT_EXT=OFF).", loc);
}
}  // namespace

DirectionSpec ReadDirections(const ParamSet &integrator, const std::optional<ParamSet> &added,
                             const PluginRegistry &registry, DiagnosticSink &sink) {
    DirectionSpec spec;
    spec.entry = &FindGuide(registry, integrator.Loc());
    spec.params =
        ChosenParams("the guide", *spec.entry, integrator, integrator.Loc(), added ? *added : ParamSet(), sink);
    return spec;
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
            throw UserError(
                fmt::format("\"{}\" is the form of flags; in a scene this is a name only, and its parameters "
                            "are such as \"float {}.floor\".",
                            Abbreviate(name), Abbreviate(name.substr(0, stop))),
                loc);
        sampler.entry = &find(name, loc);
    });
    if (!flags.choice.empty()) sampler.entry = ReadPiece(choice, pieces.sampler, find, &keys, sink);
    if (sampler.entry) {
        sampler.params = LightParams(*sampler.entry, integrator, loc, keys, sink);
        WarnOfParamsWithoutEffect(*sampler.entry, sampler.params, sink);
    }

    if (pieces.guide) {
        guide.emplace("the guide", choice.At(pieces.guide->begin));
        Collect(sink, [&] {
            const auto &entry = FindGuide(registry, guide->Loc());
            if (choice.Text()[pieces.guide->begin - 1] == ':')
                ReadKeys(choice, kGuideName, entry.params, *pieces.guide, &*guide, sink);
            entry.check(*guide);
        });
    }

    sampler.meshLights = scene.meshLights || flags.meshLights || pieces.mesh;
    // Samplers that do not accept groups form them themselves.
    if (sampler.entry && !sampler.entry->traits.takesGroups) sampler.meshLights = false;
    if (sink.ErrorCount() > errorsBefore) return {};
    return selection;
}

std::optional<LightSamplerSpec> ReadShootingSampler(const ParamSet &integrator, const std::string &named,
                                                    const std::string &flag, const PluginRegistry &registry,
                                                    DiagnosticSink &sink) {
    const size_t errorsBefore = sink.ErrorCount();
    const FlagText text("--shooting-sampler", flag);
    const auto find = [&](const std::string &name, const FileLoc &loc) -> const LightSamplerRegistry::Entry & {
        std::vector<std::string> choices;
        for (const std::string &n : registry.samplers.Names())
            if (registry.samplers.Find(n).traits.isSameEverywhere) choices.push_back(n);
        if (registry.samplers.Has(name) && !registry.samplers.Find(name).traits.isSameEverywhere)
            throw UserError(fmt::format("light sampler \"{}\" chooses by place, and light paths have none before they "
                                        "begin; {}.",
                                        name, ListChoices(name, choices)),
                            loc);
        if (!registry.samplers.Has(name)) ThrowUnknown("light sampler", name, choices, loc);
        return registry.samplers.Find(name, loc);
    };
    LightSamplerSpec spec;
    ParamSet keys;
    const FileLoc loc = integrator.LocOf("shootingsampler");
    // The scene's name is validated even if the flag overrides it.
    Collect(sink, [&] { spec.entry = &find(named, loc); });
    if (!flag.empty()) spec.entry = ReadPiece(text, {0, flag.size()}, find, &keys, sink);
    if (spec.entry) spec.params = LightParams(*spec.entry, integrator, loc, keys, sink);
    if (sink.ErrorCount() > errorsBefore) return {};
    return spec;
}

LightSelection ReadLightSelection(const std::string &choice, const PluginRegistry &registry) {
    DiagnosticSink sink;
    LightFlags flags;
    flags.choice = choice;
    std::optional<LightSelection> selection = ReadLightSelection(ParamSet(), flags, registry, sink);
    sink.ThrowIfErrors();
    return *std::move(selection);
}

}  // namespace pbrt
