// A host for FMUs of FMI 2.0 in C#: sets what is named, makes 100 steps of 10 ms and prints the outputs. seconds=30 makes
// 3000 steps.
// mcs host.cs && mono host.exe .. NAME=VALUE ...   (.. is the folder of the unpacked FMU); .NET: a console project.
// The class Fmu is for programs of your own and for game engines; FmuBehaviour.cs beside it is a component for Unity.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Runtime.InteropServices;
using System.Text;
using System.Xml;

/// <summary>An instance of an unpacked FMU for co-simulation. A refusal is an InvalidOperationException with the message
/// of the FMU. The instance has its own clock, so a pause is a time without calls.</summary>
public sealed class Fmu : IDisposable {
    public enum Status { Ok, Warning, Discard, Error, Fatal }

    /// <summary>Names of the outputs, in the order of modelDescription.xml.</summary>
    public readonly List<string> Outputs = new List<string>();
    /// <summary>Whether the run has ended, such as by a derailment. Its values stay readable.</summary>
    public bool Ended { get; private set; }
    /// <summary>Time of the instance [s], a multiple of the step: sums and clocks in single precision lose digits.</summary>
    public double Time => origin + taken * size;

    struct Variable { public uint Reference; public char Type; }
    readonly Dictionary<string, Variable> variables = new Dictionary<string, Variable>();
    readonly Action<Status, string> log;
    readonly Queue<KeyValuePair<Status, string>> messages = new Queue<KeyValuePair<Status, string>>();
    string guid, identifier;
    IntPtr library, callbacks, instance;
    GCHandle self;
    double origin, size;
    long taken;

    /// <summary>Load an unpacked FMU and make an instance. `log` receives its messages.</summary>
    public Fmu(string folder, string name, Action<Status, string> log) {
        this.log = log;
        folder = Path.GetFullPath(folder);
        ReadDescription(Path.Combine(folder, "modelDescription.xml"));
        try {
            LoadLibrary(Path.Combine(folder, "binaries"));
            Instantiate(name, Path.Combine(folder, "resources"));
        } catch {
            Dispose();
            throw;
        }
    }

    /// <summary>Set parameters and inputs, and initialise at t = 0 s.</summary>
    public void Start(IEnumerable<KeyValuePair<string, double>> values) {
        foreach (var value in values) this[value.Key] = value.Value;
        Require(Function<Setup>("fmi2SetupExperiment")(Live, 0, 0.0, 0.0, 0, 0.0), "The start time");
        Require(Function<Change>("fmi2EnterInitializationMode")(Live), "The initialisation");
        Require(Function<Change>("fmi2ExitInitializationMode")(Live), "The start");
    }

    /// <summary>Advance by a step [s]. After the end of the run this does nothing.</summary>
    public void Advance(double step) {
        if (Ended) return;
        if (step != size) {
            origin = Time;
            taken = 0;
            size = step;
        }
        int status = doStep(Live, Time, step, 1);
        Ended = status == (int)Status.Discard;
        Require(Ended ? 0 : status, "A step");
        if (!Ended) ++taken;
    }

    /// <summary>Value of a variable; a Boolean is 0 or 1.</summary>
    public double this[string name] {
        get {
            char type = Find(name);
            int status = type == 'R' ? getReal(Live, reference, One, real)
                                     : (type == 'I' ? getInteger : getBoolean)(Live, reference, One, integer);
            Require(status, name);
            return type == 'R' ? real[0] : integer[0];
        }
        set {
            char type = Find(name);
            real[0] = value;
            integer[0] = Math.Abs(value) <= int.MaxValue ? (int)value : 0;
            if (type != 'R' && integer[0] != value)
                throw new InvalidOperationException(name + " must be an integer; got " + TextOf(value) + ". Correct it.");
            Require(type == 'R' ? setReal(Live, reference, One, real)
                                : (type == 'I' ? setInteger : setBoolean)(Live, reference, One, integer),
                    name + "=" + TextOf(value));
        }
    }

    /// <summary>State of the run, from which an instance of the same FMU continues bit for bit.</summary>
    public byte[] Save() {
        IntPtr state = IntPtr.Zero;
        UIntPtr length = UIntPtr.Zero;
        Require(Function<StateOf>("fmi2GetFMUstate")(Live, ref state), "The state");
        try {
            Require(Function<SizeOf>("fmi2SerializedFMUstateSize")(Live, state, ref length), "The size of the state");
            var bytes = new byte[(int)length];
            Require(Function<ToBytes>("fmi2SerializeFMUstate")(Live, state, bytes, length), "The state");
            return bytes;
        } finally {
            Function<StateOf>("fmi2FreeFMUstate")(Live, ref state);
        }
    }

    /// <summary>Continue from a saved state, in place of Start.</summary>
    public void Restore(byte[] bytes) {
        IntPtr state = IntPtr.Zero;
        int ended = 0;
        var length = new UIntPtr((uint)bytes.Length);
        Require(Function<FromBytes>("fmi2DeSerializeFMUstate")(Live, bytes, length, ref state), "The saved state");
        try {
            Require(Function<Place>("fmi2SetFMUstate")(Live, state), "The saved state");
        } finally {
            Function<StateOf>("fmi2FreeFMUstate")(Live, ref state);
        }
        Require(Function<RealOf>("fmi2GetRealStatus")(Live, LastSuccessfulTime, ref origin), "The time of the state");
        Require(Function<BooleanOf>("fmi2GetBooleanStatus")(Live, Terminated, ref ended), "The end of the state");
        Ended = ended != 0;
        taken = 0;
    }

    /// <summary>Free the instance and its library.</summary>
    public void Dispose() {
        if (instance != IntPtr.Zero) Function<Release>("fmi2FreeInstance")(instance);
        if (library != IntPtr.Zero) Native.Close(library);
        if (callbacks != IntPtr.Zero) Marshal.FreeHGlobal(callbacks);
        if (self.IsAllocated) self.Free();
        instance = library = callbacks = IntPtr.Zero;
    }

    // ---- the folder ----

    void ReadDescription(string file) {
        string name = null, version = null;
        bool output = false;
        uint number = 0;
        if (!File.Exists(file))
            throw new InvalidOperationException("The FMU must be an unpacked folder; got no " + file + ". Unzip the FMU.");
        using (var stream = File.OpenRead(file))
        using (XmlReader xml = XmlReader.Create(stream))
            while (xml.Read()) {
                if (xml.NodeType != XmlNodeType.Element) continue;
                if (xml.Name == "fmiModelDescription") {
                    guid = xml.GetAttribute("guid");
                    version = xml.GetAttribute("fmiVersion");
                } else if (xml.Name == "CoSimulation") identifier = xml.GetAttribute("modelIdentifier");
                else if (xml.Name == "ScalarVariable") {
                    name = xml.GetAttribute("name");
                    output = xml.GetAttribute("causality") == "output";
                    number = uint.Parse(xml.GetAttribute("valueReference"), CultureInfo.InvariantCulture);
                } else if (name != null && (xml.Name == "Real" || xml.Name == "Integer" || xml.Name == "Boolean")) {
                    variables[name] = new Variable { Reference = number, Type = xml.Name[0] };
                    if (output) Outputs.Add(name);
                    name = null;
                }
            }
        if (version != "2.0" || identifier == null)
            throw new InvalidOperationException("The FMU must be for co-simulation of FMI 2.0; got version " + version + ".");
    }

    void LoadLibrary(string binaries) {
        bool arm = RuntimeInformation.ProcessArchitecture == Architecture.Arm64;
        string linux = arm ? "aarch64-linux" : "linux64";
        string platform = Native.Windows ? "win" + 8 * IntPtr.Size : Native.Apple ? "darwin64" : linux;
        string suffix = Native.Windows ? ".dll" : Native.Apple ? ".dylib" : ".so";
        string file = Path.Combine(binaries, platform, identifier + suffix);
        library = File.Exists(file) ? Native.Open(file) : IntPtr.Zero;
        if (library == IntPtr.Zero)
            throw new InvalidOperationException("The FMU must have a library for this computer; got no " + file +
                                                ". Build it with --platforms all.");
        doStep = Function<Step>("fmi2DoStep");
        getReal = Function<Reals>("fmi2GetReal");
        setReal = Function<Reals>("fmi2SetReal");
        getInteger = Function<Integers>("fmi2GetInteger");
        setInteger = Function<Integers>("fmi2SetInteger");
        getBoolean = Function<Integers>("fmi2GetBoolean");
        setBoolean = Function<Integers>("fmi2SetBoolean");
    }

    void Instantiate(string name, string resources) {
        self = GCHandle.Alloc(this);
        IntPtr[] functions = { Marshal.GetFunctionPointerForDelegate(Logger), IntPtr.Zero, IntPtr.Zero, IntPtr.Zero,
                               GCHandle.ToIntPtr(self) };
        callbacks = Marshal.AllocHGlobal(functions.Length * IntPtr.Size);
        Marshal.Copy(functions, 0, callbacks, functions.Length);
        instance = Function<Instantiation>("fmi2Instantiate")(name, CoSimulation, guid, UriOf(resources), callbacks, 0, 1);
        Require(instance != IntPtr.Zero ? 0 : (int)Status.Error, "The instance");
    }

    // FMI 2.0, section 2.1.5: a URI, which is ASCII whatever the letters of the path.
    static string UriOf(string folder) {
        var parts = folder.Replace('\\', '/').Split('/').Select(Uri.EscapeDataString);
        return "file://" + (folder[0] == '/' ? "" : "/") + string.Join("/", parts).Replace("%3A", ":");
    }

    // ---- calls ----

    IntPtr Live {
        get {
            if (instance == IntPtr.Zero) throw new ObjectDisposedException(identifier);
            return instance;
        }
    }

    char Find(string name) {
        Variable variable;
        if (!variables.TryGetValue(name, out variable))
            throw new InvalidOperationException("A name must be that of a number of " + identifier + "; got " + name +
                                                ". See modelDescription.xml.");
        reference[0] = variable.Reference;
        return variable.Type;
    }

    // Messages go to the log when the call of the FMU has returned: an exception must not pass through native code. That of
    // a refusal is the last one.
    void Require(int status, string what) {
        bool refused = status > (int)Status.Warning;
        while (messages.Count > (refused ? 1 : 0)) {
            var message = messages.Dequeue();
            log(message.Key, message.Value);
        }
        if (!refused) return;
        string reason = messages.Count > 0 ? " " + messages.Dequeue().Value : "";
        throw new InvalidOperationException(what + " was refused with status " + status + "." + reason);
    }

    // The logger of FMI 2.0 has further arguments. These FMUs pass none: the format is the message, with %% for %.
    [MonoPInvokeCallback(typeof(LoggerType))]
    static void Note(IntPtr environment, IntPtr name, int status, IntPtr category, IntPtr message) {
        int length = 0;
        while (Marshal.ReadByte(message, length) != 0) ++length;
        var bytes = new byte[length];
        Marshal.Copy(message, bytes, 0, length);
        string text = Encoding.UTF8.GetString(bytes).Replace("%%", "%");
        ((Fmu)GCHandle.FromIntPtr(environment).Target).messages.Enqueue(new KeyValuePair<Status, string>((Status)status, text));
    }

    static string TextOf(double value) => value.ToString("R", CultureInfo.InvariantCulture);

    // IL2CPP of Unity compiles callbacks in advance. It recognises them by the name of this attribute.
    sealed class MonoPInvokeCallbackAttribute : Attribute { public MonoPInvokeCallbackAttribute(Type type) {} }

    const CallingConvention C = CallingConvention.Cdecl;
    [UnmanagedFunctionPointer(C)] delegate void LoggerType(
        IntPtr environment, IntPtr name, int status, IntPtr category, IntPtr message);
    [UnmanagedFunctionPointer(C)] delegate IntPtr Instantiation(
        string name, int type, string guid, string resources, IntPtr callbacks, int visible, int logging);
    [UnmanagedFunctionPointer(C)] delegate int Setup(
        IntPtr fmu, int toleranceDefined, double tolerance, double start, int stopDefined, double stop);
    [UnmanagedFunctionPointer(C)] delegate int Change(IntPtr fmu);
    [UnmanagedFunctionPointer(C)] delegate void Release(IntPtr fmu);
    [UnmanagedFunctionPointer(C)] delegate int Step(IntPtr fmu, double time, double size, int noSetStatePriorToTime);
    [UnmanagedFunctionPointer(C)] delegate int Reals(IntPtr fmu, uint[] references, UIntPtr count, double[] values);
    [UnmanagedFunctionPointer(C)] delegate int Integers(IntPtr fmu, uint[] references, UIntPtr count, int[] values);
    [UnmanagedFunctionPointer(C)] delegate int StateOf(IntPtr fmu, ref IntPtr state);
    [UnmanagedFunctionPointer(C)] delegate int Place(IntPtr fmu, IntPtr state);
    [UnmanagedFunctionPointer(C)] delegate int SizeOf(IntPtr fmu, IntPtr state, ref UIntPtr size);
    [UnmanagedFunctionPointer(C)] delegate int ToBytes(IntPtr fmu, IntPtr state, byte[] bytes, UIntPtr size);
    [UnmanagedFunctionPointer(C)] delegate int FromBytes(IntPtr fmu, byte[] bytes, UIntPtr size, ref IntPtr state);
    [UnmanagedFunctionPointer(C)] delegate int RealOf(IntPtr fmu, int kind, ref double value);
    [UnmanagedFunctionPointer(C)] delegate int BooleanOf(IntPtr fmu, int kind, ref int value);

    static readonly LoggerType Logger = Note; // a field, so that it is never collected
    const int CoSimulation = 1, LastSuccessfulTime = 2, Terminated = 3;
    static readonly UIntPtr One = new UIntPtr(1);
    Step doStep;
    Reals getReal, setReal;
    Integers getInteger, setInteger, getBoolean, setBoolean;
    // Used again by every call, so that frames leave no garbage.
    readonly uint[] reference = new uint[1];
    readonly double[] real = new double[1];
    readonly int[] integer = new int[1];

    T Function<T>(string name) {
        IntPtr address = Native.Find(library, name);
        if (address == IntPtr.Zero) throw new InvalidOperationException("The library must have " + name + "; got none.");
        return Marshal.GetDelegateForFunctionPointer<T>(address);
    }

    // Shared libraries of Windows, Linux and macOS.
    static class Native {
        public static readonly bool Windows = RuntimeInformation.IsOSPlatform(OSPlatform.Windows);
        public static readonly bool Apple = RuntimeInformation.IsOSPlatform(OSPlatform.OSX);
        const string Linux = "libdl.so.2", Mac = "libSystem.dylib";
        const int Now = 2;

        public static IntPtr Open(string file) =>
            Windows ? LoadLibraryW(file) : Apple ? OpenMac(file, Now) : OpenLinux(file, Now);
        public static IntPtr Find(IntPtr library, string name) =>
            Windows ? GetProcAddress(library, name) : Apple ? FindMac(library, name) : FindLinux(library, name);
        public static int Close(IntPtr library) =>
            Windows ? FreeLibrary(library) : Apple ? CloseMac(library) : CloseLinux(library);

        [DllImport("kernel32", CharSet = CharSet.Unicode)] static extern IntPtr LoadLibraryW(string file);
        [DllImport("kernel32")] static extern IntPtr GetProcAddress(IntPtr library, string name);
        [DllImport("kernel32")] static extern int FreeLibrary(IntPtr library);
        [DllImport(Linux, EntryPoint = "dlopen")] static extern IntPtr OpenLinux(string file, int flags);
        [DllImport(Linux, EntryPoint = "dlsym")] static extern IntPtr FindLinux(IntPtr library, string name);
        [DllImport(Linux, EntryPoint = "dlclose")] static extern int CloseLinux(IntPtr library);
        [DllImport(Mac, EntryPoint = "dlopen")] static extern IntPtr OpenMac(string file, int flags);
        [DllImport(Mac, EntryPoint = "dlsym")] static extern IntPtr FindMac(IntPtr library, string name);
        [DllImport(Mac, EntryPoint = "dlclose")] static extern int CloseMac(IntPtr library);
    }
}

static class Host {
    static KeyValuePair<string, double> Assigned(string assignment) {
        string[] parts = assignment.Split('=');
        double value;
        if (parts.Length == 2 && double.TryParse(parts[1], NumberStyles.Float, CultureInfo.InvariantCulture, out value))
            return new KeyValuePair<string, double>(parts[0], value);
        throw new InvalidOperationException("An argument must be NAME=VALUE, with a number such as 0.2, without a unit; got "
                                            + assignment + ". Correct it.");
    }

    static int Main(string[] arguments) {
        try {
            string folder = arguments.Length > 0 ? arguments[0] : "..";
            using (var fmu = new Fmu(folder, "host", (status, text) => Console.Error.WriteLine(status + ": " + text))) {
                var given = arguments.Skip(1).Select(Assigned).ToList();
                fmu.Start(given.Where(one => one.Key != "seconds"));
                double seconds = given.Where(one => one.Key == "seconds").Select(one => one.Value).DefaultIfEmpty(1.0).Last();
                if (!(seconds >= 0.0 && seconds <= 1e7))
                    throw new InvalidOperationException("seconds must be from 0 to 1e7; got " + seconds + ". Correct it.");
                for (int n = 0; n < Math.Round(100.0 * seconds); ++n) fmu.Advance(0.01);
                foreach (string name in fmu.Outputs)
                    Console.WriteLine(name + " " + fmu[name].ToString("R", CultureInfo.InvariantCulture));
            }
            return 0;
        } catch (Exception refused) {
            Console.Error.WriteLine(refused.Message);
            return 1;
        }
    }
}
