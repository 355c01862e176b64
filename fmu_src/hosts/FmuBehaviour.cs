// A component for Unity that runs an FMU in step with FixedUpdate. It needs the class Fmu of host.cs, and the unpacked FMU
// in the folder Assets/StreamingAssets.
using System;
using System.IO;
using System.Linq;
using UnityEngine;
using Named = System.Collections.Generic.KeyValuePair<string, double>;

/// <summary>Other scripts set inputs and read outputs by name: GetComponent&lt;FmuBehaviour&gt;()["speed"]. Each fixed step
/// of the game is a step of the FMU. A disabled component keeps its state, also if scripts are compiled during play.
/// </summary>
[DefaultExecutionOrder(-100)] // before scripts that read its outputs
public class FmuBehaviour : MonoBehaviour {
    [Serializable] public struct StartValue {
        public string name;
        public double value;
    }

    [Tooltip("Folder of the unpacked FMU in StreamingAssets.")] public string folder = "BrakedVehicle";
    [Tooltip("Parameters and inputs at the start.")] public StartValue[] startValues = new StartValue[0];
    [SerializeField, HideInInspector] byte[] state = new byte[0]; // of a run that waits
    Fmu fmu;

    public double this[string variable] {
        get => Running[variable];
        set => Running[variable] = value;
    }
    /// <summary>Whether the FMU makes steps: it is enabled, and its run has not ended, such as by a derailment.</summary>
    public bool Runs => fmu != null && !fmu.Ended;
    /// <summary>Time of the FMU [s], without pauses.</summary>
    public double Seconds => Running.Time;

    /// <summary>Begin again from the start values.</summary>
    public void Restart() {
        enabled = false;
        state = new byte[0];
        enabled = true;
    }

    Fmu Running =>
        fmu ?? throw new InvalidOperationException(name + ": FmuBehaviour must be enabled; enable it to use its FMU.");

    void OnEnable() {
        try {
            fmu = new Fmu(Path.Combine(Application.streamingAssetsPath, folder), name, Log);
            if (state.Length > 0) fmu.Restore(state);
            else fmu.Start(startValues.Select(start => new Named(start.name, start.value)));
        } catch (Exception refused) {
            Free();
            Stop(refused);
        }
    }

    // Unity calls this also before it compiles scripts, leaves a scene or quits.
    void OnDisable() {
        if (fmu != null) state = fmu.Save();
        Free();
    }

    // A float of 0.02 is 0.0199999996; the decimal number is 0.02.
    void FixedUpdate() {
        try {
            fmu.Advance((double)(decimal)Time.fixedDeltaTime);
        } catch (Exception refused) {
            Stop(refused);
        }
    }

    void Free() {
        if (fmu != null) fmu.Dispose();
        fmu = null;
    }

    void Stop(Exception refused) {
        Debug.LogError(name + ": " + refused.Message + " The component is disabled.", this);
        enabled = false;
    }

    void Log(Fmu.Status status, string text) {
        if (status == Fmu.Status.Ok) Debug.Log(name + ": " + text, this);
        else Debug.LogWarning(name + ": " + text, this);
    }
}
