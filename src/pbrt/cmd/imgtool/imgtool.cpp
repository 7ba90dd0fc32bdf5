#include <fmt/ranges.h>

#include <algorithm>
#include <new>

#include "pbrt/cmd/flags.h"
#include "pbrt/cmd/imgtool/commands.h"
#include "pbrt/core/log.h"
#include "pbrt/core/memory.h"
#include "pbrt/core/version.h"

namespace {

using namespace pbrt;
using namespace pbrt::imgtool;

/// Flags of stock's imgtool without a counterpart.
const FlagHints kStockFlags = {
    {"acesfilmic", "this program has another curve, --tonemap"},
    {"preservecolors", "this program has another curve, --tonemap"},
    {"despike", "this program limits bright pixels with --clamp"},
    {"colorspace", "the directive ColorSpace of the scene sets the colour space of an image"},
    {"difftol", "compare the printed error, or that of --json"}};

std::string OptionNames(const CLI::App &app) {
    std::string names;
    for (const CLI::Option *option : app.get_options())
        if (!option->get_lnames().empty()) names += (names.empty() ? "--" : ", --") + option->get_lnames()[0];
    return names;
}

std::vector<std::string> CommandNames(const CLI::App &app) {
    std::vector<std::string> names;
    for (const CLI::App *command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
    return names;
}

const CLI::App *FindCommand(const CLI::App &app, const std::string &name) {
    for (const CLI::App *command : app.get_subcommands(nullptr))
        if (command->get_name() == name) return command;
    return nullptr;
}

// Prints the error with the valid choices to standard error. `chosen`: the command, or null.
int ReportUsage(const CLI::App &app, const CLI::App *chosen, const CLI::ParseError &e) {
    fmt::print(stderr, "Error: {}\n", MessageOf(e));
    if (!chosen)
        fmt::print(stderr, "Commands: {}\nUsage: imgtool COMMAND ...; see imgtool help\n",
                   fmt::join(CommandNames(app), " "));
    else
        fmt::print(stderr, "Options of {}: {}\nSee imgtool help {}\n", chosen->get_name(), OptionNames(*chosen),
                   chosen->get_name());
    return 1;
}

void AddHelp(CLI::App &app, Action &action) {
    auto name = std::make_shared<std::string>();
    CLI::App *command = app.add_subcommand("help", "Explain a command");
    command->add_option("command", *name, "Name of the command");
    command->footer("Example: imgtool help diff");
    auto overview = std::make_shared<std::string>(app.help());
    command->callback([name, overview, &app, &action] {
        action = [name, overview, &app] {
            // app.help() would describe the current command.
            if (name->empty()) {
                fmt::print("{}", *overview);
                return 0;
            }
            const CLI::App *chosen = FindCommand(app, *name);
            if (!chosen) throw UserError("No such command: {}; {}", *name, ListChoices(*name, CommandNames(app)));
            fmt::print("{}", chosen->help(app.get_name()));
            return 0;
        };
    });
}

int Run(int argc, char **argv) {
    CLI::App app(
        "Inspects, converts and compares images: .exr, .png, .pfm, .jpg and, for reading, .hdr, .tga and others.",
        "imgtool");
    app.require_subcommand(1);
    app.footer("Example: imgtool info render.exr");
    app.set_version_flag("--version", VersionText(), "print the version, and stop");
    Action action;
    for (CommandAdder *add :
         {AddInfo, AddConvert, AddDiff, AddError, AddFalsecolor, AddAverage, AddAssemble, AddMerge, AddSplitn, AddBloom,
          AddWhitebalance, AddScalenormalmap, AddMakeequiarea, AddMakesky, AddHelp})
        add(app, action);

    const std::string first = argc > 1 ? argv[1] : "";
    const CLI::App *const command = FindCommand(app, first);
    if (!command && !first.empty() && first[0] != '-')
        throw UserError("No such command: {}; {}", first, ListChoices(first, CommandNames(app)));
    std::vector<std::string> arguments;
    for (int i = 1; i < argc; ++i) arguments.push_back(CanonicalFlag(command ? *command : app, argv[i]));
    try {
        CheckFlags(command ? *command : app, arguments, kStockFlags);
        std::reverse(arguments.begin(), arguments.end());  // CLI11 expects reverse order
        app.parse(arguments);
    } catch (const CLI::CallForHelp &) {
        fmt::print("{}", command ? command->help(app.get_name()) : app.help());
        return 0;
    } catch (const CLI::CallForVersion &) {
        fmt::print("{}\n", VersionText());
        return 0;
    } catch (const CLI::ParseError &e) {
        return ReportUsage(app, command, e);
    }
    PBRT_CHECK(action);
    return action();
}

}  // namespace

int main(int argc, char **argv) {
    try {
        return FinishOutput(Run(argc, argv));
    } catch (const UserError &e) {
        for (const Diagnostic &d : e.Diagnostics()) fmt::print(stderr, "{}\n", Format(d));
    } catch (const std::exception &e) {
        const bool isMemory = dynamic_cast<const std::bad_alloc *>(&e) != nullptr;
        fmt::print(stderr, "Error: {}\n", isMemory ? OutOfMemoryText("") : e.what());
    }
    return 1;
}
