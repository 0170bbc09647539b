//! Packs over the network: OCI registries, and files behind https.
//!
//! A pack is an OCI artifact: one layer, the pack's file, with the manifest as its configuration. Its signature is another
//! artifact that refers to it, so that `referrers` finds it; where a registry has no such list, it is kept as the tag that
//! the OCI specification gives for this case.

use std::collections::BTreeMap;
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use docker_credential::DockerCredential;
use engine::diagnostic::{Diagnostic, Result, printable};
use oci_client::client::{Client, ClientConfig, ClientProtocol, Config, ImageLayer};
use oci_client::errors::{OciDistributionError, OciErrorCode};
use oci_client::manifest::{
    ImageIndexEntry, OCI_IMAGE_INDEX_MEDIA_TYPE, OCI_IMAGE_MEDIA_TYPE, OciDescriptor, OciImageIndex, OciImageManifest,
};
use oci_client::secrets::RegistryAuth;
use oci_client::{Reference, RegistryOperation};
use pack::{MAX_PACK_BYTES, Pack, Signature};
use tokio::io::AsyncWrite;

/// What a pack, its manifest and its signature are in a registry.
const PACK_TYPE: &str = "application/vnd.engine.pack.v1.tar";
const MANIFEST_TYPE: &str = "application/vnd.engine.pack.manifest.v1+toml";
const SIGNATURE_TYPE: &str = "application/vnd.engine.pack.signature.v1";
/// The configuration of an artifact that has none.
const EMPTY_TYPE: &str = "application/vnd.oci.empty.v1+json";
const MAX_SIGNATURE_BYTES: usize = 16 << 10;
const CONNECT: Duration = Duration::from_secs(10);
const READ: Duration = Duration::from_secs(60);
/// How long a file may take in all: a server that sends a byte a second holds nobody up for ever.
const WHOLE: Duration = Duration::from_secs(600);
const MOST_REDIRECTS: usize = 5;

/// The bytes of a pack and the text of its signature.
pub(super) fn fetch(address: &str) -> Result<(Vec<u8>, Option<String>)> {
    if let Some(reference) = address.strip_prefix("oci://") {
        let reference = parse(reference)?;
        return block_on(pull(&reference)).map_err(|error| failed(address, &error));
    }
    if address.starts_with("https://") {
        return block_on(download(address)).map_err(|error| failed(address, &error));
    }
    let message = format!("'{}' is no address of a pack", printable(address));
    let help = "write oci://host/name:version, https://host/file.pack, or a path";
    Diagnostic::new("E-PACK-ADDRESS", message).help(help).fail()
}

/// Pushes a pack and its signature; the answer pins what was pushed.
pub(super) fn push(pack: &Pack, signature: Option<&Signature>, address: &str) -> Result<String> {
    let Some(target) = address.strip_prefix("oci://") else {
        let message = format!("'{}' is no place to push to", printable(address));
        let help = "write oci://host/name, or the path of a folder";
        return Diagnostic::new("E-PACK-ADDRESS", message).help(help).fail();
    };
    let last = target.rsplit('/').next().unwrap_or(target);
    let target = if last.contains(':') { target.to_owned() } else { format!("{target}:{}", pack.manifest().version) };
    let reference = parse(&target)?;
    let digest = block_on(push_all(pack, signature, &reference)).map_err(|error| failed(address, &error))?;
    Ok(format!("oci://{}/{}@{digest}", reference.registry(), reference.repository()))
}

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn block_on<T>(work: impl Future<Output = std::result::Result<T, Failure>>) -> std::result::Result<T, Failure> {
    // Another part of the program may have chosen a provider already; then that one serves.
    let _ = rustls::crypto::ring::default_provider().install_default();
    tokio::runtime::Builder::new_current_thread().enable_all().build()?.block_on(work)
}

/// What a registry answers that is more than a fault of the network.
#[derive(Debug)]
enum Refused {
    /// It has the pack, but not this version; the versions that it has.
    Version(Vec<String>),
    /// The bytes are not those whose digest was asked for.
    Bytes,
}

impl std::fmt::Display for Refused {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Version(_) => to.write_str("there is no such version"),
            Self::Bytes => to.write_str("the registry gave other bytes than it named"),
        }
    }
}

impl std::error::Error for Refused {}

fn refused(address: &str, refused: &Refused) -> Box<Diagnostic> {
    let address = printable(address);
    Box::new(match refused {
        Refused::Version(known) => {
            let message = format!("there is no version '{address}'");
            let help = match known.as_slice() {
                [] => "the registry has no version of this pack".to_owned(),
                known => format!("there are: {}", printable(&known.join(", "))),
            };
            Diagnostic::new("E-PACK-VERSION", message).help(help)
        }
        Refused::Bytes => {
            let message = format!("the registry gave other bytes for '{address}' than it named");
            let help = "do not use them: get the pack from its author, and tell whoever runs the registry";
            Diagnostic::new("E-PACK-BYTES", message).help(help)
        }
    })
}

fn failed(address: &str, error: &Failure) -> Box<Diagnostic> {
    if let Some(kind) = error.downcast_ref::<Refused>() {
        return refused(address, kind);
    }
    let mut reason = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        reason = format!("{reason}: {inner}");
        cause = inner.source();
    }
    let message = format!("'{}' did not work: {}", printable(address), printable(&reason));
    let help = if reason.contains("certificate") {
        "do not go on unless the server is your own: then name its authority's file in SSL_CERT_FILE"
    } else {
        "check the address and the network; for a private registry: docker login, or skopeo login"
    };
    Box::new(Diagnostic::new("E-PACK-NETWORK", message).help(help))
}

fn parse(text: &str) -> Result<Reference> {
    Reference::try_from(text).map_err(|error| {
        let message = format!("'{}' is no address in a registry: {error}", printable(text));
        Box::new(Diagnostic::new("E-PACK-ADDRESS", message).help("write oci://host/name:version"))
    })
}

fn client(reference: &Reference) -> Client {
    let registry = reference.resolve_registry();
    let host = registry.rsplit_once(':').map_or(registry, |(host, _)| host);
    // A registry on this machine has no certificate; everything else is https.
    let own = matches!(host, "localhost" | "127.0.0.1" | "[::1]");
    let protocol = if own { ClientProtocol::HttpsExcept(vec![registry.to_owned()]) } else { ClientProtocol::Https };
    Client::new(ClientConfig {
        protocol,
        connect_timeout: Some(CONNECT),
        read_timeout: Some(READ),
        ..ClientConfig::default()
    })
}

/// Credentials as Docker keeps them, helpers included; without any, nobody's.
fn credentials(reference: &Reference) -> RegistryAuth {
    match docker_credential::get_credential(reference.resolve_registry()) {
        Ok(DockerCredential::UsernamePassword(name, password)) => RegistryAuth::Basic(name, password),
        Ok(DockerCredential::IdentityToken(token)) => RegistryAuth::Bearer(token),
        Err(_) => RegistryAuth::Anonymous,
    }
}

async fn push_all(
    pack: &Pack,
    signature: Option<&Signature>,
    reference: &Reference,
) -> std::result::Result<String, Failure> {
    let (client, auth) = (client(reference), credentials(reference));
    let manifest_text = pack.file("manifest.toml").unwrap_or_default().to_vec();
    let name = &pack.manifest().name;
    let annotations = BTreeMap::from([
        ("org.opencontainers.image.title".to_owned(), pack.manifest().file_name()),
        ("org.opencontainers.image.version".to_owned(), pack.manifest().version.to_string()),
        ("org.opencontainers.image.licenses".to_owned(), pack.manifest().license.clone()),
        ("org.opencontainers.image.description".to_owned(), format!("{name}: {}", pack.manifest().description)),
    ]);
    // The title on the layer too: other clients name the file by it.
    let title = BTreeMap::from([("org.opencontainers.image.title".to_owned(), pack.manifest().file_name())]);
    let layers = [ImageLayer::new(pack.bytes().to_vec(), PACK_TYPE.to_owned(), Some(title))];
    let config = Config::new(manifest_text, MANIFEST_TYPE.to_owned(), None);
    let mut image = OciImageManifest::build(&layers, &config, Some(annotations));
    image.media_type = Some(OCI_IMAGE_MEDIA_TYPE.to_owned());
    image.artifact_type = Some(PACK_TYPE.to_owned());
    client.push(reference, &layers, config, &auth, Some(image)).await?;
    let digest = client.fetch_manifest_digest(reference, &auth).await?;
    if let Some(signature) = signature {
        let (stored, _) = client.pull_manifest_raw(reference, &auth, &[OCI_IMAGE_MEDIA_TYPE]).await?;
        let subject = descriptor(OCI_IMAGE_MEDIA_TYPE, &digest, stored.len());
        push_signature(&client, &auth, signature, &reference.clone_with_digest(digest.clone()), subject).await?;
    }
    Ok(digest)
}

async fn push_signature(
    client: &Client,
    auth: &RegistryAuth,
    signature: &Signature,
    pack: &Reference,
    subject: OciDescriptor,
) -> std::result::Result<(), Failure> {
    let tag = subject.digest.replace(':', "-");
    let layers = [ImageLayer::new(signature.text().as_bytes().to_vec(), SIGNATURE_TYPE.to_owned(), None)];
    let config = Config::new(b"{}".to_vec(), EMPTY_TYPE.to_owned(), None);
    let mut image = OciImageManifest::build(&layers, &config, None);
    image.media_type = Some(OCI_IMAGE_MEDIA_TYPE.to_owned());
    image.artifact_type = Some(SIGNATURE_TYPE.to_owned());
    image.subject = Some(subject);
    let at = |tag: String| Reference::with_tag(pack.registry().to_owned(), pack.repository().to_owned(), tag);
    let own = at(format!("{tag}.minisig"));
    client.push(&own, &layers, config, auth, Some(image)).await?;
    let digest = client.fetch_manifest_digest(&own, auth).await?;
    let referrers = client.pull_referrers(pack, Some(SIGNATURE_TYPE)).await?;
    if referrers.manifests.iter().any(|entry| entry.digest == digest) {
        return Ok(());
    }
    let (stored, _) = client.pull_manifest_raw(&own, auth, &[OCI_IMAGE_MEDIA_TYPE]).await?;
    let entry = ImageIndexEntry {
        media_type: OCI_IMAGE_MEDIA_TYPE.to_owned(),
        digest,
        size: i64::try_from(stored.len())?,
        artifact_type: Some(SIGNATURE_TYPE.to_owned()),
        platform: None,
        annotations: None,
    };
    let index = OciImageIndex {
        schema_version: 2,
        media_type: Some(OCI_IMAGE_INDEX_MEDIA_TYPE.to_owned()),
        manifests: vec![entry],
        artifact_type: None,
        annotations: None,
    };
    client.auth(&own, auth, RegistryOperation::Push).await?;
    client.push_manifest_list(&at(tag), auth, index).await?;
    Ok(())
}

fn descriptor(media_type: &str, digest: &str, size: usize) -> OciDescriptor {
    OciDescriptor {
        media_type: media_type.to_owned(),
        digest: digest.to_owned(),
        size: i64::try_from(size).unwrap_or(i64::MAX),
        ..OciDescriptor::default()
    }
}

async fn pull(reference: &Reference) -> std::result::Result<(Vec<u8>, Option<String>), Failure> {
    let (client, auth) = (client(reference), credentials(reference));
    let (image, digest) = match client.pull_image_manifest(reference, &auth).await {
        Ok(found) => found,
        Err(error) if is_missing(&error) => return Err(no_version(&client, &auth, reference, error).await),
        Err(error) => return Err(error.into()),
    };
    let bytes = only_layer(&client, reference, &image, PACK_TYPE, MAX_PACK_BYTES).await?;
    let by_digest = reference.clone_with_digest(digest);
    let referrers = client.pull_referrers(&by_digest, Some(SIGNATURE_TYPE)).await?;
    let Some(entry) = referrers.manifests.first() else { return Ok((bytes, None)) };
    let own = reference.clone_with_digest(entry.digest.clone());
    let (image, _) = client.pull_image_manifest(&own, &auth).await?;
    let text = only_layer(&client, &own, &image, SIGNATURE_TYPE, MAX_SIGNATURE_BYTES).await?;
    Ok((bytes, Some(String::from_utf8(text)?)))
}

fn is_missing(error: &OciDistributionError) -> bool {
    match error {
        OciDistributionError::ImageManifestNotFoundError(_) => true,
        OciDistributionError::RegistryError { envelope, .. } => {
            envelope.errors.iter().any(|error| error.code == OciErrorCode::ManifestUnknown)
        }
        OciDistributionError::ServerError { code, .. } => *code == 404,
        _ => false,
    }
}

/// The versions that a registry has of a pack of which one is missing; the first error if it does not tell them.
async fn no_version(
    client: &Client,
    auth: &RegistryAuth,
    reference: &Reference,
    error: OciDistributionError,
) -> Failure {
    match client.list_tags(reference, auth, None, None).await {
        // A signature without a list of referrers is kept as a tag.
        Ok(found) => {
            Refused::Version(found.tags.into_iter().filter(|tag| !tag.starts_with("sha256-")).collect()).into()
        }
        Err(_) => error.into(),
    }
}

/// The one layer of an artifact. Its digest is checked by the client, its size on the bytes that really come.
async fn only_layer(
    client: &Client,
    reference: &Reference,
    image: &OciImageManifest,
    media_type: &str,
    limit: usize,
) -> std::result::Result<Vec<u8>, Failure> {
    let [layer] = image.layers.as_slice() else {
        return Err(format!("it has {} layers instead of one", image.layers.len()).into());
    };
    if layer.media_type != media_type {
        return Err(format!("it is of the type {}, not {media_type}: no behaviour pack", layer.media_type).into());
    }
    let mut out = Limited { bytes: Vec::new(), limit };
    match client.pull_blob(reference, layer, &mut out).await {
        Ok(()) => Ok(out.bytes),
        Err(OciDistributionError::DigestError(_)) => Err(Refused::Bytes.into()),
        Err(error) => Err(error.into()),
    }
}

async fn download(address: &str) -> std::result::Result<(Vec<u8>, Option<String>), Failure> {
    let client = reqwest::Client::builder().https_only(true).connect_timeout(CONNECT).read_timeout(READ);
    let client = client.timeout(WHOLE).redirect(redirects()).build()?;
    let bytes = get(&client, address, MAX_PACK_BYTES).await?.ok_or("there is no such file")?;
    let signature = get(&client, &format!("{address}.minisig"), MAX_SIGNATURE_BYTES).await?;
    Ok((bytes, signature.map(String::from_utf8).transpose()?))
}

/// What a server may answer instead of a file: a few addresses, https alone, and to another server nothing that was only
/// meant for the first: an address with a name and a password in it leads nowhere else.
fn redirects() -> reqwest::redirect::Policy {
    reqwest::redirect::Policy::custom(|attempt| {
        let (first, next) = (attempt.previous().first(), attempt.url());
        let elsewhere = first.is_some_and(|first| {
            (first.host_str(), first.port_or_known_default()) != (next.host_str(), next.port_or_known_default())
        });
        let secret = first.is_some_and(|first| !first.username().is_empty() || first.password().is_some());
        if attempt.previous().len() > MOST_REDIRECTS {
            attempt.error("it leads on and on")
        } else if next.scheme() != "https" || !next.username().is_empty() || (elsewhere && secret) {
            attempt.error("it leads to where a pack must not be fetched from")
        } else {
            attempt.follow()
        }
    })
}

/// A file of at most so many bytes; nothing if the server has none.
async fn get(client: &reqwest::Client, address: &str, limit: usize) -> std::result::Result<Option<Vec<u8>>, Failure> {
    let mut response = client.get(address).send().await?;
    if response.status() == reqwest::StatusCode::NOT_FOUND {
        return Ok(None);
    }
    response = response.error_for_status()?;
    let mut bytes = Vec::new();
    while let Some(chunk) = response.chunk().await? {
        if bytes.len() + chunk.len() > limit {
            return Err(format!("it has more than {limit} bytes").into());
        }
        bytes.extend_from_slice(&chunk);
    }
    Ok(Some(bytes))
}

/// Memory that takes so many bytes and no more, whatever the sender said before.
struct Limited {
    bytes: Vec<u8>,
    limit: usize,
}

impl AsyncWrite for Limited {
    fn poll_write(mut self: Pin<&mut Self>, _: &mut Context<'_>, part: &[u8]) -> Poll<io::Result<usize>> {
        if self.bytes.len() + part.len() > self.limit {
            return Poll::Ready(Err(io::Error::other(format!("it has more than {} bytes", self.limit))));
        }
        self.bytes.extend_from_slice(part);
        Poll::Ready(Ok(part.len()))
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }
}
