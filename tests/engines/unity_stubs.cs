// What engines/unity uses of Unity, without a body: enough to compile against.
using System;

namespace UnityEngine
{
    public class AnimationEvent
    {
        public string functionName { get; set; }
        public string stringParameter { get; set; }
        public float time { get; set; }
    }

    public static class JsonUtility
    {
        public static T FromJson<T>(string json) { throw new NotImplementedException(); }
    }
}

namespace UnityEditor
{
    public class AssetImporter { }

    public class AssetPostprocessor
    {
        public string assetPath { get; set; }
        public AssetImporter assetImporter { get { throw new NotImplementedException(); } }
    }

    public enum ModelImporterAnimationType { None, Legacy, Generic, Human }

    public class ModelImporterClipAnimation
    {
        public bool loopTime { get; set; }
        public bool loopPose { get; set; }
        public bool lockRootRotation { get; set; }
        public bool lockRootPositionXZ { get; set; }
        public bool lockRootHeightY { get; set; }
        public bool keepOriginalOrientation { get; set; }
        public bool keepOriginalPositionXZ { get; set; }
        public bool keepOriginalPositionY { get; set; }
        public UnityEngine.AnimationEvent[] events { get; set; }
    }

    public class ModelImporter : AssetImporter
    {
        public ModelImporterAnimationType animationType { get; set; }
        public bool useFileScale { get; set; }
        public bool importAnimation { get; set; }
        public string motionNodeName { get; set; }
        public ModelImporterClipAnimation[] defaultClipAnimations { get { throw new NotImplementedException(); } }
        public ModelImporterClipAnimation[] clipAnimations { get; set; }
    }
}
