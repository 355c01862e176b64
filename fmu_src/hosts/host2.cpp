// A host for @MODEL@.fmu in C++17 on one page: sets what is named, makes 100 steps of 10 ms and prints the outputs.
// seconds=30 makes 3000 steps. NAME[2]=VALUE sets the second element of an array, and NAME=VALUE all of them.
// c++ -std=c++17 -I../sources host.cpp -ldl -o host && ./host ../binaries/linux64/@MODEL@.so NAME=VALUE ...
// Data of the FMU are in its folder resources, beside that of its binaries.
#include <cstdio>
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
    std::fprintf(stderr, "%s: %s\n", instance, message);
}

// One instance of the FMU; it is freed with this object.
class Fmu {
  public:
    explicit Fmu(const Library &library) : library(library) {
        instance = function<fmi2InstantiateTYPE>("fmi2Instantiate")(
            "host", fmi2CoSimulation, "@GUID@", library.resources().c_str(), &callbacks, fmi2False, fmi2False);
        require(instance ? fmi2OK : fmi2Error, "The instance");
    }
    ~Fmu() { function<fmi2FreeInstanceTYPE>("fmi2FreeInstance")(instance); }
    Fmu(const Fmu &) = delete;
    Fmu &operator=(const Fmu &) = delete;

    void set(const std::string &assignment) {
        const auto equals = assignment.find('='), length = assignment.find_first_of("[=");
        const bool is_one = equals != length;
        const auto element = is_one ? std::stoul(assignment.substr(length + 1)) : 1;
        for (const auto &variable : SETTABLE) {
            if (equals == std::string::npos || variable.name != assignment.substr(0, length)) continue;
            if (element < 1 || element > variable.count) break;
            const double number = std::stod(assignment.substr(equals + 1));
            for (fmi2ValueReference k = 0; k < variable.count; ++k)
                if (!is_one || k + 1 == element) put(variable, k, number, assignment);
            return;
        }
        require(fmi2Error, assignment);
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
    double get(const Variable &variable, fmi2ValueReference element) const {
        const fmi2ValueReference reference = variable.reference + element;
        fmi2Real real = 0.0;
        fmi2Integer integer = 0;
        const bool is_real = variable.type == 'r';
        require(is_real ? function<fmi2GetRealTYPE>("fmi2GetReal")(instance, &reference, 1, &real)
                        : function<fmi2GetIntegerTYPE>("fmi2GetInteger")(instance, &reference, 1, &integer),
                variable.name);
        return is_real ? real : integer;
    }

  private:
    void put(const Variable &variable, fmi2ValueReference element, fmi2Real real, const std::string &assignment) {
        const fmi2ValueReference reference = variable.reference + element;
        const auto integer = static_cast<fmi2Integer>(real);
        require(variable.type == 'r' ? function<fmi2SetRealTYPE>("fmi2SetReal")(instance, &reference, 1, &real)
                                     : function<fmi2SetIntegerTYPE>("fmi2SetInteger")(instance, &reference, 1, &integer),
                assignment);
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

int main(int count, char **argument) try {
    const Library library(count > 1 ? argument[1] : "");
    Fmu fmu(library);
    const std::string seconds = "seconds=";
    int steps = 100;
    for (int next = 2; next < count; ++next) {
        const std::string given = argument[next];
        if (given.compare(0, seconds.size(), seconds) != 0) fmu.set(given);
        else steps = static_cast<int>(100.0 * std::stod(given.substr(seconds.size())) + 0.5);
    }
    fmu.start();
    for (int n = 0; n < steps; ++n) fmu.step(n * 0.01, 0.01);
    for (const auto &variable : OUTPUT)
        for (fmi2ValueReference k = 0; k < variable.count; ++k) {
            const std::string element = variable.count > 1 ? "[" + std::to_string(k + 1) + "]" : "";
            std::printf("%s%s %.17g\n", variable.name.c_str(), element.c_str(), fmu.get(variable, k));
        }
    return 0;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
