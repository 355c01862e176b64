// A host for @MODEL@.fmu in C++17 on one page: sets what is named, makes 100 steps of 10 ms and prints the outputs.
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

// Names, value references and types (real, integer) from modelDescription.xml.
struct Variable {
    std::string name;
    fmi2ValueReference reference;
    char type;
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
        const auto length = assignment.find('=');
        for (const auto &variable : SETTABLE) {
            if (length == std::string::npos || variable.name != assignment.substr(0, length)) continue;
            const fmi2Real real = std::stod(assignment.substr(length + 1));
            const auto integer = static_cast<fmi2Integer>(real);
            require(variable.type == 'r'
                        ? function<fmi2SetRealTYPE>("fmi2SetReal")(instance, &variable.reference, 1, &real)
                        : function<fmi2SetIntegerTYPE>("fmi2SetInteger")(instance, &variable.reference, 1, &integer),
                    assignment);
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
    double get(const Variable &variable) const {
        fmi2Real value = 0.0;
        require(function<fmi2GetRealTYPE>("fmi2GetReal")(instance, &variable.reference, 1, &value), variable.name);
        return value;
    }

  private:
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
    for (int next = 2; next < count; ++next) fmu.set(argument[next]);
    fmu.start();
    for (int n = 0; n < 100; ++n) fmu.step(n * 0.01, 0.01);
    for (const auto &variable : OUTPUT) std::printf("%s %.17g\n", variable.name.c_str(), fmu.get(variable));
    return 0;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
