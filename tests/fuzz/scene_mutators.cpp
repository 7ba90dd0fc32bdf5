#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <map>
#include <set>
#include <string_view>

#include "fuzz/mutators.h"

namespace pbrt::fuzz {

namespace {

/// A stretch of a text: a token, a parameter with its values, or a whole statement.
struct Span {
    size_t begin, end;
};
enum class TokenKind { String, Number, Word, Bracket };
struct Token : Span {
    TokenKind kind;
};

std::vector<Token> Tokens(const std::string &text) {
    std::vector<Token> tokens;
    for (size_t i = 0; i < text.size();) {
        const auto c = static_cast<unsigned char>(text[i]);
        size_t end = i + 1;
        if (std::isspace(c) || c == '#') {
            i = c == '#' ? std::min(text.find('\n', i), text.size()) : end;
            continue;
        }
        TokenKind kind = TokenKind::Bracket;
        if (c == '"') {
            end = std::min(text.find('"', end), text.size() - 1) + 1;
            kind = TokenKind::String;
        } else if (c != '[' && c != ']') {
            while (end < text.size() && !std::isspace(static_cast<unsigned char>(text[end])) &&
                   !std::strchr("\"[]#", text[end]))
                ++end;
            kind = std::isalpha(c) ? TokenKind::Word : TokenKind::Number;
        }
        tokens.push_back({{i, end}, kind});
        i = end;
    }
    return tokens;
}

bool IsDirective(const std::string &text, const Token &t) {
    return t.kind == TokenKind::Word && std::isupper(static_cast<unsigned char>(text[t.begin]));
}

std::vector<Span> Statements(const std::string &text, const std::vector<Token> &tokens) {
    std::vector<Span> spans;
    for (const Token &t : tokens) {
        if (IsDirective(text, t)) spans.push_back(t);
        else if (!spans.empty()) spans.back().end = t.end;
    }
    return spans;
}

std::vector<Span> Parameters(const std::string &text, const std::vector<Token> &tokens) {
    std::vector<Span> spans;
    for (size_t i = 0; i + 1 < tokens.size(); ++i) {
        const std::string_view name(text.data() + tokens[i].begin, tokens[i].end - tokens[i].begin);
        if (tokens[i].kind != TokenKind::String || name.find(' ') == std::string_view::npos) continue;
        size_t last = i + 1;
        if (text[tokens[last].begin] == '[')
            while (last + 1 < tokens.size() && text[tokens[last].begin] != ']') ++last;
        spans.push_back({tokens[i].begin, tokens[last].end});
    }
    return spans;
}

std::string Cut(const std::string &text, Span s) { return text.substr(s.begin, s.end - s.begin); }
void Replace(std::string &text, Span s, const std::string &by) { text.replace(s.begin, s.end - s.begin, by); }

std::vector<Span> Of(const std::vector<Token> &tokens, TokenKind kind) {
    std::vector<Span> spans;
    for (const Token &t : tokens)
        if (t.kind == kind) spans.push_back(t);
    return spans;
}

/// Exchanges two stretches, of which the first must end before the second begins.
void Swap(std::string &text, Span a, Span b) {
    if (a.end > b.begin) return;
    const std::string one = Cut(text, a), other = Cut(text, b);
    Replace(text, b, one);
    Replace(text, a, other);
}

std::string Repeat(const std::string &what, size_t times) {
    std::string out;
    for (size_t i = 0; i < times; ++i) out += what;
    return out;
}

/// 2 to 30,000, small numbers more often.
size_t HowMany(Dice &dice) {
    static constexpr std::array<size_t, 8> kTimes = {2, 5, 30, 66, 300, 1100, 5000, 30000};
    return dice.Pick(kTimes);
}

void MutateNumbers(std::string &text, const SceneWords &, Dice &dice) {
    const std::vector<Span> numbers = Of(Tokens(text), TokenKind::Number);
    if (numbers.empty()) return;
    const Span s = dice.Pick(numbers);
    MutateNumberInText(text, s.begin, s.end, dice);
}

void MutateNames(std::string &text, const SceneWords &words, Dice &dice) {
    static const std::vector<std::string> kOdd = {"\"\"",      "\"\\\"",        "\"../assets\"", "\"scene.pbrt\"",
                                                  "\".\"",     "\"/dev/null\"", "\"/dev/zero\"", "\"none\"",
                                                  "\"float\"", "\"\xff\xfe\"",  "\"\xc3\xa4\"",  "true",
                                                  "7"};
    const size_t way = dice.Below(6);
    const std::vector<Span> spans = Of(Tokens(text), way == 0 ? TokenKind::Word : TokenKind::String);
    if (spans.empty()) return;
    switch (way) {
        case 0:
        case 2: Replace(text, dice.Pick(spans), Cut(text, dice.Pick(spans))); break;
        case 1: Replace(text, dice.Pick(spans), dice.Pick(kOdd)); break;
        case 3:
            if (dice.OneIn(5)) Replace(text, dice.Pick(spans), '"' + std::string(1 + dice.Below(20000), 'x') + '"');
            break;
        default: Replace(text, dice.Pick(spans), dice.Pick(words.strings));
    }
}

void MutateTypes(std::string &text, const SceneWords &, Dice &dice) {
    static const std::vector<std::string> kTypes = WordsOf(
        "float integer bool string rgb spectrum blackbody texture point3 point2 vector3 vector2 normal point "
        "color float[]");
    const std::vector<Span> parameters = Parameters(text, Tokens(text));
    if (parameters.empty()) return;
    const size_t begin = dice.Pick(parameters).begin + 1, end = std::min(text.find_first_of(" \"", begin), text.size());
    text.replace(begin, end - begin, dice.Pick(kTypes));
}

void MutateArray(std::string &text, Dice &dice) {
    const std::vector<Span> parameters = Parameters(text, Tokens(text));
    if (parameters.empty()) return;
    const Span s = dice.Pick(parameters);
    const size_t open = text.find('[', s.begin);
    const Span list =
        open < s.end ? Span{open + 1, s.end - 1} : Span{std::min(text.find('"', s.begin + 1) + 1, s.end), s.end};
    std::string values = Cut(text, list);
    const std::vector<Token> inner = Tokens(values);
    switch (dice.Below(7)) {
        case 0: values.clear(); break;
        case 1: values += values; break;
        case 2: values = Repeat(values + ' ', HowMany(dice) / std::max<size_t>(1, values.size() / 10) + 1); break;
        case 3:
            if (!inner.empty()) values.erase(dice.Pick(inner).begin);
            break;
        case 4:
            if (!inner.empty()) Replace(values, dice.Pick(inner), "");
            break;
        case 5:
            if (!inner.empty()) values.insert(dice.Pick(inner).begin, ExtremeNumber(dice) + ' ');
            break;
        default: values += ' ' + ExtremeNumber(dice);
    }
    if (open >= s.end) values = " [ " + values + " ]";
    Replace(text, list, values);
}

void MutateParameters(std::string &text, const SceneWords &words, Dice &dice) {
    const std::vector<Span> parameters = Parameters(text, Tokens(text));
    if (parameters.empty()) return;
    const Span a = dice.Pick(parameters), b = dice.Pick(parameters);
    switch (dice.Below(8)) {
        case 0: Replace(text, a, ""); break;
        case 1: text.insert(a.end, ' ' + Cut(text, a)); break;
        case 2: Swap(text, a, b); break;
        case 3: text.insert(a.end, ' ' + Cut(text, b)); break;
        case 4: text.insert(a.end, ' ' + dice.Pick(words.parameters)); break;
        case 5: Replace(text, a, dice.Pick(words.parameters)); break;
        default: MutateArray(text, dice);
    }
}

void MutateStatements(std::string &text, const SceneWords &words, Dice &dice) {
    const std::vector<Span> statements = Statements(text, Tokens(text));
    if (statements.empty()) return;
    const Span a = dice.Pick(statements), b = dice.Pick(statements);
    const std::string one = Cut(text, a);
    switch (dice.Below(7)) {
        case 0: Replace(text, a, ""); break;
        case 1: text.insert(b.begin, one + '\n'); break;
        case 2: Swap(text, a, b); break;
        case 3: text.insert(b.begin, dice.Pick(words.statements) + '\n'); break;
        case 4: Replace(text, a, dice.Pick(words.statements)); break;
        case 5:
            if (a.begin < b.begin) text.erase(a.begin, b.begin - a.begin);
            break;
        default: text.insert(a.begin, Repeat(one + '\n', HowMany(dice) / (1 + one.size() / 40) + 1));
    }
}

/// Mutates nesting: deeply nested blocks, objects and textures, and objects that contain themselves.
void MutateNesting(std::string &text, const SceneWords &, Dice &dice) {
    const std::vector<Span> statements = Statements(text, Tokens(text));
    if (statements.empty()) return;
    const Span s = dice.Pick(statements);
    const size_t n = HowMany(dice);
    const size_t world = std::min(text.find("WorldBegin"), text.size() - 10) + 10;
    std::string chain;
    switch (dice.Below(12)) {
        case 0: Replace(text, s, Repeat("AttributeBegin ", n) + Cut(text, s) + Repeat(" AttributeEnd", n)); break;
        case 1: text.insert(s.begin, Repeat("AttributeBegin ", n)); break;
        case 2: text.insert(s.begin, Repeat("AttributeEnd ", n)); break;
        case 3: text.insert(s.begin, Repeat("TransformBegin ", n)); break;
        case 4: text.insert(s.begin, Repeat("ObjectBegin \"x\" ", n)); break;
        case 5: text.insert(s.end, Repeat(" [", n)); break;
        case 6: text.insert(s.begin, "Include \"scene.pbrt\"\n"); break;
        case 7:
            chain = "\nTexture \"t0\" \"spectrum\" \"constant\" \"rgb value\" [ .5 .5 .5 ]\n";
            for (size_t i = 1; i < n; ++i)
                chain += fmt::format(
                    "Texture \"t{}\" \"spectrum\" \"{}\" \"texture tex1\" \"t{}\" \"texture tex\" \"t{}\"\n", i,
                    i % 2 ? "scale" : "mix", i - 1, i - 1);
            text.insert(
                world,
                fmt::format(
                    "{}Material \"diffuse\" \"texture reflectance\" \"t{}\" Shape \"sphere\" \"float radius\" 50\n",
                    chain, n - 1));
            break;
        case 8:
            chain = fmt::format("\nMakeNamedMaterial \"m{}\" \"string type\" \"diffuse\"\n", n);
            for (size_t i = 0; i < n; ++i)
                chain += fmt::format(
                    "MakeNamedMaterial \"m{}\" \"string type\" \"mix\" \"string materials\" [ \"m{}\" \"m{}\" ]\n", i,
                    i ? i - 1 : n, i / 2);
            text.insert(world,
                        fmt::format("{}NamedMaterial \"m{}\" Shape \"sphere\" \"float radius\" 50\n", chain, n - 1));
            break;
        case 9:
            chain = "\n";
            for (size_t i = 0; i < n; ++i)
                chain += fmt::format("ObjectBegin \"o{}\" ObjectInstance \"o{}\" ObjectEnd\n", i, i ? i - 1 : n - 1);
            text.insert(world, fmt::format("{}ObjectInstance \"o{}\"\n", chain, n - 1));
            break;
        case 10:
            Replace(text, s, "ObjectBegin \"x\" " + Cut(text, s) + " ObjectEnd " + Repeat("ObjectInstance \"x\" ", n));
            break;
        default: Replace(text, s, Repeat("Scale 2 2 .5 Rotate 30 1 0 0 ", std::min<size_t>(n, 1100)) + Cut(text, s));
    }
}

void MutateSplice(std::string &text, const SceneWords &words, Dice &dice) {
    const std::string &other = dice.Pick(words.texts);
    const std::vector<Span> mine = Statements(text, Tokens(text)), theirs = Statements(other, Tokens(other));
    if (mine.empty() || theirs.empty()) return;
    const bool atStatements = !dice.OneIn(4);
    const size_t from = atStatements ? dice.Pick(mine).begin : dice.Below(text.size());
    const size_t to = atStatements ? dice.Pick(theirs).begin : dice.Below(other.size());
    text = text.substr(0, from) + other.substr(to);
}

void MutateSceneBytes(std::string &text, const SceneWords &, Dice &dice) { MutateBytes(text, text.size(), dice); }

using SceneMutator = void (*)(std::string &, const SceneWords &, Dice &);
const std::map<std::string, SceneMutator> kMutators = {
    {"scene-bytes", MutateSceneBytes},      {"scene-names", MutateNames},
    {"scene-nesting", MutateNesting},       {"scene-numbers", MutateNumbers},
    {"scene-parameters", MutateParameters}, {"scene-splice", MutateSplice},
    {"scene-statements", MutateStatements}, {"scene-types", MutateTypes}};

}  // namespace

const std::vector<std::string> &SceneKinds() {
    static const auto kinds = [] {
        std::vector<std::string> names;
        for (const auto &[name, mutate] : kMutators) names.push_back(name);
        return names;
    }();
    return kinds;
}

SceneWords::SceneWords(const std::vector<std::string> &scenes) : texts(scenes) {
    std::set<std::string> s, p, st;
    for (const std::string &text : scenes) {
        const std::vector<Token> tokens = Tokens(text);
        for (Span span : Of(tokens, TokenKind::String)) s.insert(Cut(text, span));
        for (Span span : Parameters(text, tokens)) p.insert(Cut(text, span));
        for (Span span : Statements(text, tokens)) st.insert(Cut(text, span));
    }
    strings.assign(s.begin(), s.end());
    parameters.assign(p.begin(), p.end());
    statements.assign(st.begin(), st.end());
}

void MutateScene(std::string &text, const std::string &kind, const SceneWords &words, Dice &dice) {
    kMutators.at(kind)(text, words, dice);
}

}  // namespace pbrt::fuzz
