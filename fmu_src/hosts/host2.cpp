// A host for @MODEL@.fmu in C++17 on one page: sets what is named, makes 100 steps of 10 ms and prints the outputs.
// seconds=30 makes 3000 steps. NAME[2]=VALUE sets the second element of an array, and NAME=VALUE all of them.
// c++ -std=c++17 -I../sources host.cpp -ldl -o host && ./host ../binaries/linux64/@MODEL@.so NAME=VALUE ...
// Data of the FMU are in its folder resources, beside that of its binaries. A program of yours may include this file, with
// WITHOUT_MAIN defined, for its class Fmu.
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "fmi2FunctionTypes.h"
#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

// Names, value references, types (real, integer) and numbers of elements, from modelDescription.xml.
struct Variable {
    std::string name;
    fmi2ValueReference reference;
    char type;
    fmi2ValueReference count;
};
const std::vector<Variable> SETTABLE = {
@SETTABLE@
}, OUTPUT = {
@OUTPUT@
};

class Library {
  public:
#ifdef _WIN32
    explicit Library(const std::string &path) : path(path), handle(LoadLibraryA(path.c_str())) {}
    void *find(const char *name) const { return reinterpret_cast<void *>(GetProcAddress(handle, name)); }
    const std::string path;
    HMODULE handle;
#else
    explicit Library(const std::string &path) : path(path), handle(dlopen(path.c_str(), RTLD_NOW)) {}
    void *find(const char *name) const { return handle ? dlsym(handle, name) : nullptr; }
    const std::string path;
    void *handle;
#endif
    std::string resources() const { return path.substr(0, path.find_last_of("/\\") + 1) + "../../resources"; }
};

static void require(fmi2Status status, const std::string &what) {
    if (status > fmi2Warning) throw std::runtime_error(what + " was refused with status " + std::to_string(status) + ".");
}

static void log_message(fmi2ComponentEnvironment, fmi2String instance, fmi2Status, fmi2String, fmi2String message, ...) {
    va_list rest;
    va_start(rest, message);
    std::fprintf(stderr, "%s: ", instance);
    std::vfprintf(stderr, message, rest);
    std::fputc('\n', stderr);
    va_end(rest);
}

static void check(bool is_right, const std::string &limit, const std::string &value, const std::string &remedy) {
    if (!is_right) throw std::runtime_error(limit + "; got " + value + ". " + remedy);
}

// One instance of the FMU; it is freed with this object. Elements of an array count from 1; a number has one.
class Fmu {
  public:
    explicit Fmu(const Library &library) : library(library) {
        instance = function<fmi2InstantiateTYPE>("fmi2Instantiate")(
            "host", fmi2CoSimulation, "@GUID@", library.resources().c_str(), &callbacks, fmi2False, fmi2True);
        require(instance ? fmi2OK : fmi2Error, "The instance");
    }
    ~Fmu() { function<fmi2FreeInstanceTYPE>("fmi2FreeInstance")(instance); }
    Fmu(const Fmu &) = delete;
    Fmu &operator=(const Fmu &) = delete;

    void set(const std::string &name, std::size_t element, double number) {
        const auto &variable = find(name, element);
        const fmi2ValueReference reference = variable.reference + static_cast<fmi2ValueReference>(element - 1);
        const bool is_real = variable.type == 'r', is_whole = std::fabs(number) < 2e9 && number == std::floor(number);
        check(is_real || is_whole, name + " must be an integer", std::to_string(number), "Correct it.");
        const auto integer = static_cast<fmi2Integer>(is_whole ? number : 0.0);
        require(is_real ? function<fmi2SetRealTYPE>("fmi2SetReal")(instance, &reference, 1, &number)
                        : function<fmi2SetIntegerTYPE>("fmi2SetInteger")(instance, &reference, 1, &integer),
                name + "[" + std::to_string(element) + "] = " + std::to_string(number));
    }
    // All elements.
    void set(const std::string &name, double number) {
        for (std::size_t k = 1; k <= find(name, 1).count; ++k) set(name, k, number);
    }
    void start() {
        require(function<fmi2SetupExperimentTYPE>("fmi2SetupExperiment")(instance, fmi2False, 0.0, 0.0, fmi2False, 0.0),
                "The start time");
        require(function<fmi2EnterInitializationModeTYPE>("fmi2EnterInitializationMode")(instance), "The initialisation");
        require(function<fmi2ExitInitializationModeTYPE>("fmi2ExitInitializationMode")(instance), "The start");
    }
    void step(double time, double size) {
        require(function<fmi2DoStepTYPE>("fmi2DoStep")(instance, time, size, fmi2True), "A step");
    }
    double get(const std::string &name, std::size_t element = 1) const {
        const auto &variable = find(name, element);
        const fmi2ValueReference reference = variable.reference + static_cast<fmi2ValueReference>(element - 1);
        fmi2Real real = 0.0;
        fmi2Integer integer = 0;
        const bool is_real = variable.type == 'r';
        require(is_real ? function<fmi2GetRealTYPE>("fmi2GetReal")(instance, &reference, 1, &real)
                        : function<fmi2GetIntegerTYPE>("fmi2GetInteger")(instance, &reference, 1, &integer),
                name);
        return is_real ? real : integer;
    }

  private:
    static const Variable &find(const std::string &name, std::size_t element) {
        for (const auto *table : {&SETTABLE, &OUTPUT})
            for (const auto &variable : *table) {
                if (variable.name != name) continue;
                const auto limit = "The element of " + name + " must be from 1 to " + std::to_string(variable.count);
                check(1 <= element && element <= variable.count, limit, std::to_string(element), "Correct it.");
                return variable;
            }
        throw std::runtime_error("A name must be that of a parameter, input or output; got " + name +
                                 ". See modelDescription.xml.");
    }
    template <class Type> Type *function(const char *name) const {
        void *found = library.find(name);
        if (!found) throw std::runtime_error("The library as the first argument has no " + std::string(name) + ".");
        return reinterpret_cast<Type *>(found);
    }
    const Library &library;
    const fmi2CallbackFunctions callbacks{log_message, nullptr, nullptr, nullptr, nullptr};
    fmi2Component instance = nullptr;
};

#ifndef WITHOUT_MAIN
// The number that a whole text is.
static double number_in(const std::string &text, const std::string &name) {
    char *end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    const bool is_plain = !text.empty() && text.find_first_not_of("+-.0123456789eE") == std::string::npos;
    check(is_plain && !*end && std::isfinite(number), name + " must be a number", text, "Write it as 0.2, without a unit.");
    return number;
}

// Set what NAME=VALUE or NAME[ELEMENT]=VALUE says.
static void assign(Fmu &fmu, const std::string &argument) {
    const auto equals = argument.find('='), end = argument.find_first_of("[=");
    check(equals != std::string::npos, "An argument must be NAME=VALUE or NAME[ELEMENT]=VALUE", argument, "Correct it.");
    const auto name = argument.substr(0, end);
    const double number = number_in(argument.substr(equals + 1), name);
    if (end == equals) return fmu.set(name, number);
    const auto element = argument.substr(end + 1, equals - end - 2);
    const bool is_count = element.find_first_not_of("0123456789") == std::string::npos && !element.empty();
    check(is_count && element.size() < 8 && argument[equals - 1] == ']', "The element of " + name + " must be an integer",
          argument, "Write " + name + "[1]=VALUE.");
    fmu.set(name, std::stoul(element), number);
}

int main(int count, char **argument) try {
    const Library library(count > 1 ? argument[1] : "");
    Fmu fmu(library);
    const std::string seconds = "seconds=";
    int steps = 100;
    for (int next = 2; next < count; ++next) {
        const std::string text = argument[next];
        if (text.compare(0, seconds.size(), seconds) != 0) {
            assign(fmu, text);
            continue;
        }
        const double time = number_in(text.substr(seconds.size()), "seconds");
        check(0.0 <= time && time <= 1e7, "seconds must be from 0 to 1e7", text, "Correct it.");
        steps = static_cast<int>(100.0 * time + 0.5);
    }
    fmu.start();
    for (int n = 0; n < steps; ++n) fmu.step(n * 0.01, 0.01);
    for (const auto &variable : OUTPUT)
        for (std::size_t k = 1; k <= variable.count; ++k) {
            const std::string element = variable.count > 1 ? "[" + std::to_string(k) + "]" : "";
            std::printf("%s%s %.17g\n", variable.name.c_str(), element.c_str(), fmu.get(variable.name, k));
        }
    return 0;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
#endif
