// The part of UnityEngine that FmuBehaviour.cs and the page use, and a game: frames of random length, slow motion, pauses,
// compilations of scripts. mono game.exe STREAMING_ASSETS SECONDS NAME=VALUE ... prints steps, interruptions and values.
using System;
using System.Collections.Generic;
using System.Globalization;
using System.Linq;
using System.Reflection;
using UnityEngine;

namespace UnityEngine {
    public class SerializeField : Attribute {}
    public class HideInInspector : Attribute {}
    public class TooltipAttribute : Attribute { public TooltipAttribute(string text) {} }
    public class RangeAttribute : Attribute { public RangeAttribute(float least, float most) {} }
    public class RequireComponent : Attribute { public RequireComponent(Type type) {} }
    public class DefaultExecutionOrder : Attribute { public DefaultExecutionOrder(int order) {} }
    public static class Application { public static string streamingAssetsPath; }
    public static class Time { public static float fixedDeltaTime = 0.02f, timeScale = 1f; }
    public static class Mathf { public const float Rad2Deg = 57.29578f; }
    public struct Vector3 {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
    }
    public struct Quaternion {
        public float x, y, z; // Euler's angles alone
        public static Quaternion Euler(float x, float y, float z) { return new Quaternion { x = x, y = y, z = z }; }
    }
    public class Transform {
        public Vector3 localPosition;
        public Quaternion localRotation;
    }

    public static class Debug {
        public static void Log(object message, object context) { Console.Error.WriteLine("log " + message); }
        public static void LogWarning(object message, object context) { Console.Error.WriteLine("warning " + message); }
        public static void LogError(object message, object context) { Console.Error.WriteLine("error " + message); }
    }

    public class MonoBehaviour {
        public static readonly Dictionary<Type, object> Components = new Dictionary<Type, object>();
        public readonly Transform transform = new Transform();
        public string name = "coach";
        bool active;
        public bool enabled {
            get { return active; }
            set {
                if (value == active) return;
                active = value;
                Call(value ? "OnEnable" : "OnDisable");
            }
        }
        public T GetComponent<T>() { return (T)Components[typeof(T)]; }
        public void Call(string function) {
            MethodInfo method = GetType().GetMethod(function, BindingFlags.Instance | BindingFlags.NonPublic);
            if (method != null) method.Invoke(this, null);
        }
        // Scripts are compiled: a new object has the serialised fields of the old one, and nothing else of it.
        public T Reloaded<T>() where T : MonoBehaviour, new() {
            bool was = enabled;
            enabled = false;
            var copy = new T { name = name };
            const BindingFlags All = BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic;
            foreach (FieldInfo field in typeof(T).GetFields(All))
                if (!field.IsInitOnly && (field.IsPublic || field.IsDefined(typeof(SerializeField), false)))
                    field.SetValue(copy, field.GetValue(this));
            Components[typeof(T)] = copy;
            copy.enabled = was;
            return copy;
        }
    }
}

static class Game {
    static readonly Random random = new Random(1);
    static readonly Dictionary<string, double> shown = new Dictionary<string, double>();
    static FmuBehaviour coach = new FmuBehaviour();
    static CoachView view = new CoachView();
    static int steps;

    static bool Chance(string what) {
        bool happens = random.NextDouble() < 0.001;
        if (happens) shown[what] = shown.ContainsKey(what) ? shown[what] + 1 : 1;
        return happens;
    }

    // Inputs by the number of steps, as the reference run has them. A fifth of the steps is slow motion, as the manual of
    // Unity advises: the fixed step shrinks with the scale of time.
    static void Step() {
        bool slow = steps / 500 % 5 == 4, brakes = steps % 3000 >= 2000;
        Time.timeScale = slow ? 0.25f : 1f;
        Time.fixedDeltaTime = 0.02f * Time.timeScale;
        view.brake = brakes ? 1f : 0f;
        for (int i = 1; i <= 4; ++i) coach["traction_torque_" + i] = brakes ? 0.0 : 2e3;
        coach["friction_2"] = steps / 3000 % 2 == 1 ? 0.05 : 0.3;
        coach.Call("FixedUpdate");
        view.Call("FixedUpdate");
        ++steps;
    }

    static void Frame(ref double behind) {
        double real = Chance("hitches") ? 1.0 : 1.0 / 240 + random.NextDouble() * (1.0 / 30 - 1.0 / 240);
        if (Chance("compilations")) {
            coach = coach.Reloaded<FmuBehaviour>();
            view = view.Reloaded<CoachView>();
        }
        if (Chance("switched_off")) coach.enabled = false;
        if (coach.enabled) behind += Math.Min(real, 1.0 / 3.0) * Time.timeScale;
        for (; coach.Runs && behind >= Time.fixedDeltaTime; behind -= Time.fixedDeltaTime) Step();
        coach.enabled = true;
        if (Chance("pauses")) Time.timeScale = 0f; // until the next frame: no step is due
        else if (Time.timeScale == 0f) Time.timeScale = Time.fixedDeltaTime / 0.02f;
    }

    static FmuBehaviour.StartValue Assigned(string assignment) {
        string[] parts = assignment.Split('=');
        return new FmuBehaviour.StartValue { name = parts[0], value = double.Parse(parts[1]) };
    }

    static void Main(string[] arguments) {
        CultureInfo.CurrentCulture = new CultureInfo("");
        Application.streamingAssetsPath = arguments[0];
        MonoBehaviour.Components[typeof(FmuBehaviour)] = coach;
        coach.startValues = arguments.Skip(2).Select(Assigned).ToArray();
        coach.enabled = view.enabled = true;
        double behind = 0.0, end = double.Parse(arguments[1]);
        while (coach.Runs && coach.Seconds < end) Frame(ref behind);
        try {
            string[] names = { "speed", "distance", "rotation_1", "slip_2", "locked_2", "brake_torque_3", "body_lateral",
                               "body_bounce", "body_roll", "body_pitch", "body_yaw" };
            foreach (string name in names) shown[name] = coach[name];
            Vector3 place = view.transform.localPosition;
            Quaternion turned = view.transform.localRotation;
            float[] numbers = { place.x, place.y, place.z, turned.x, turned.y, turned.z };
            for (int i = 0; i < 6; ++i) shown["place_" + i] = numbers[i];
            shown["steps"] = steps;
            foreach (var pair in shown) Console.WriteLine(pair.Key + " " + pair.Value.ToString("R"));
            coach.Restart();
            if (coach.Seconds != 0.0 || coach["distance"] != 0.0) Console.Error.WriteLine("error: a restart begins later");
            coach.enabled = false;
        } catch (InvalidOperationException refused) {
            Console.Error.WriteLine("refused " + refused.Message);
        }
    }
}
