// A host for @MODEL@.fmu in C# on one page: sets what is named, makes 100 steps of 10 ms and prints the outputs.
// Beside the program lies ../binaries/linux64/@MODEL@.so as lib@MODEL@.so, on Windows win64/@MODEL@.dll.
// Data of the FMU are in its folder resources, here as seen from the folder where the program runs.
// Mono: mcs host.cs && mono host.exe NAME=VALUE ...; .NET: a console project with this file.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.Runtime.InteropServices;

// Names, value references and types (real, integer) from modelDescription.xml.
class Variables : Dictionary<string, KeyValuePair<uint, char>> {
    public void Add(string name, uint reference, char type) { Add(name, new KeyValuePair<uint, char>(reference, type)); }
}

static class Host {
    const string Library = "@MODEL@", Resources = "../resources";
    const int CoSimulation = 1, Warning = 1, Error = 3;

    static readonly Variables Settable = new Variables {
@SETTABLE@
    };
    static readonly Variables Output = new Variables {
@OUTPUT@
    };

    delegate void Logger(IntPtr environment, string instance, int status, string category, string message);
    [StructLayout(LayoutKind.Sequential)]
    struct Callbacks { public Logger Log; public IntPtr Allocate, Free, Finished, Environment; }

    [DllImport(Library)] static extern IntPtr fmi2Instantiate(
        string name, int type, string guid, string resources, IntPtr callbacks, int visible, int logging);
    [DllImport(Library)] static extern void fmi2FreeInstance(IntPtr fmu);
    [DllImport(Library)] static extern int fmi2SetupExperiment(
        IntPtr fmu, int toleranceDefined, double tolerance, double start, int stopDefined, double stop);
    [DllImport(Library)] static extern int fmi2EnterInitializationMode(IntPtr fmu);
    [DllImport(Library)] static extern int fmi2ExitInitializationMode(IntPtr fmu);
    [DllImport(Library)] static extern int fmi2SetReal(IntPtr fmu, uint[] references, UIntPtr count, double[] values);
    [DllImport(Library)] static extern int fmi2SetInteger(IntPtr fmu, uint[] references, UIntPtr count, int[] values);
    [DllImport(Library)] static extern int fmi2GetReal(IntPtr fmu, uint[] references, UIntPtr count, double[] values);
    [DllImport(Library)] static extern int fmi2DoStep(IntPtr fmu, double time, double size, int noReturn);

    static readonly UIntPtr One = new UIntPtr(1);

    static void Require(int status, string what) {
        if (status > Warning) throw new InvalidOperationException(what + " was refused with status " + status + ".");
    }

    static void Set(IntPtr fmu, string assignment) {
        string[] parts = assignment.Split('=');
        if (parts.Length != 2 || !Settable.ContainsKey(parts[0])) Require(Error, assignment);
        double real = double.Parse(parts[1], CultureInfo.InvariantCulture);
        uint[] reference = { Settable[parts[0]].Key };
        Require(Settable[parts[0]].Value == 'r' ? fmi2SetReal(fmu, reference, One, new[] { real })
                                                : fmi2SetInteger(fmu, reference, One, new[] { (int)real }), assignment);
    }

    static void Run(IntPtr fmu, string[] assignments) {
        Require(fmu != IntPtr.Zero ? 0 : Error, "The instance");
        foreach (string assignment in assignments) Set(fmu, assignment);
        Require(fmi2SetupExperiment(fmu, 0, 0.0, 0.0, 0, 0.0), "The start time");
        Require(fmi2EnterInitializationMode(fmu), "The initialisation");
        Require(fmi2ExitInitializationMode(fmu), "The start");
        for (int n = 0; n < 100; ++n) Require(fmi2DoStep(fmu, n * 0.01, 0.01, 1), "A step");
        foreach (var variable in Output) {
            double[] value = { 0.0 };
            Require(fmi2GetReal(fmu, new[] { variable.Value.Key }, One, value), variable.Key);
            Console.WriteLine(variable.Key + " " + value[0].ToString("R", CultureInfo.InvariantCulture));
        }
    }

    static int Main(string[] assignments) {
        var callbacks = new Callbacks { Log = (environment, instance, status, category, message) =>
            Console.Error.WriteLine(instance + ": " + message) };
        IntPtr memory = Marshal.AllocHGlobal(Marshal.SizeOf(callbacks)), fmu = IntPtr.Zero;
        Marshal.StructureToPtr(callbacks, memory, false);
        try {
            fmu = fmi2Instantiate("host", CoSimulation, "@GUID@", Resources, memory, 0, 0);
            Run(fmu, assignments);
            return 0;
        } catch (Exception refused) {
            Console.Error.WriteLine(refused.Message);
            return 1;
        } finally {
            if (fmu != IntPtr.Zero) fmi2FreeInstance(fmu);
            Marshal.FreeHGlobal(memory);
            GC.KeepAlive(callbacks);
        }
    }
}
